/* Conjugate gradients preconditioned by smoothed aggregation (PETSc's GAMG), where PETSc was found
 * (LOPIN_PETSC); else functions that say so.
 *
 * Each vertex (a node) has `block` places, whether it has as many equations or not: an empty place
 * is a row of its own with the mean of the diagonal, so that aggregates are made of whole vertices.
 * The rigid motions of the bodies span what the coarse levels must hold (Vanek, Mandel and Brezina
 * 1996). Matrices come symmetric, lower triangle only, by columns, 0-based. */
enum { LOPIN_OK = 0, LOPIN_ABSENT = 1, LOPIN_NO_MEMORY = 2, LOPIN_FAILED = 3 };

#ifndef LOPIN_PETSC

int lopin_multigrid_present(void) { return 0; }
void lopin_multigrid_free(void **handle) { *handle = 0; }

int lopin_multigrid_create(void **handle, int n, int vertices, int block, const int *place,
                           int modes, const double *motion, const int *p, const int *i,
                           const double *x)
{
    (void)n; (void)vertices; (void)block; (void)place; (void)modes; (void)motion;
    (void)p; (void)i; (void)x;
    *handle = 0;
    return LOPIN_ABSENT;
}

int lopin_multigrid_solve(void *handle, double tolerance, int most, double *x, int *iterations)
{
    (void)handle; (void)tolerance; (void)most; (void)x;
    *iterations = 0;
    return LOPIN_ABSENT;
}

#else

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <petscksp.h>

typedef struct {
    int n;
    int *place;              /* (n) row of the padded matrix */
    PetscInt rows, *p, *j;   /* the padded matrix by rows */
    double *x;
    Mat matrix;
    Vec right, answer;
    KSP solver;
} multigrid_type;

int lopin_multigrid_present(void) { return 1; }

static void end_petsc(void) { PetscFinalize(); }

/* What PETSC_OPTIONS says goes first. */
static int set_default(const char *name, const char *value)
{
    PetscBool set = PETSC_FALSE;

    if (PetscOptionsHasName(NULL, NULL, name, &set)) return LOPIN_FAILED;
    return !set && PetscOptionsSetValue(NULL, name, value) ? LOPIN_FAILED : LOPIN_OK;
}

/* Once a process: no handlers of signals, no words on the terminal. */
static int start_petsc(void)
{
    static int state = -1;
    PetscBool on = PETSC_FALSE;

    if (state >= 0) return state;
    state = LOPIN_FAILED;
    PetscInitialized(&on);
    if (!on) {
        if (PetscOptionsSetValue(NULL, "-no_signal_handler", "1")) return state;
        if (PetscInitializeNoArguments()) return state;
        atexit(end_petsc);
    }
    PetscPushErrorHandler(PetscReturnErrorHandler, NULL);
    if (set_default("-lopin_mg_levels_ksp_type", "chebyshev")
        || set_default("-lopin_mg_levels_pc_type", "jacobi")
        || set_default("-lopin_mg_levels_ksp_max_it", "2")
        || set_default("-lopin_pc_gamg_coarse_eq_limit", "1000")) return state;
    return state = LOPIN_OK;
}

void lopin_multigrid_free(void **handle)
{
    multigrid_type *m = *handle;

    if (!m) return;
    KSPDestroy(&m->solver);
    VecDestroy(&m->right);
    VecDestroy(&m->answer);
    MatDestroy(&m->matrix);
    free(m->place);
    free(m->p);
    free(m->j);
    free(m->x);
    free(m);
    *handle = 0;
}

static int by_column(const void *a, const void *b)
{
    const PetscInt one = *(const PetscInt *)a, other = *(const PetscInt *)b;
    return (one > other) - (one < other);
}

/* Both triangles by rows, columns in order, empty places filled. */
static int fill_rows(multigrid_type *m, const int *p, const int *i, const double *x)
{
    const int n = m->n;
    double mean = 0.0;
    PetscInt *next, r;
    int k, c;
    size_t most = 0;

    m->p = calloc(m->rows + 1, sizeof *m->p);
    next = malloc(m->rows*sizeof *next);
    if (!m->p || !next) { free(next); return LOPIN_NO_MEMORY; }
    for (r = 0; r < m->rows; r++) next[r] = -1;
    for (c = 0; c < n; c++) {
        next[m->place[c]] = c;
        for (k = p[c]; k < p[c + 1]; k++) {
            m->p[m->place[c] + 1]++;
            if (i[k] != c) m->p[m->place[i[k]] + 1]++;
            else mean += fabs(x[k])/n;
        }
    }
    for (r = 0; r < m->rows; r++) {
        if (next[r] < 0) m->p[r + 1] = 1;
        if ((size_t)m->p[r + 1] > most) most = m->p[r + 1];
        if (m->p[r + 1] > PETSC_MAX_INT - m->p[r]) { free(next); return LOPIN_NO_MEMORY; }
        m->p[r + 1] += m->p[r];
    }
    m->j = malloc(m->p[m->rows]*sizeof *m->j);
    m->x = malloc(m->p[m->rows]*sizeof *m->x);
    if (!m->j || !m->x) { free(next); return LOPIN_NO_MEMORY; }
    for (r = 0; r < m->rows; r++) {
        if (next[r] < 0) {
            m->j[m->p[r]] = r;
            m->x[m->p[r]] = mean;
        }
        next[r] = m->p[r];
    }
    for (c = 0; c < n; c++) {
        for (k = p[c]; k < p[c + 1]; k++) {
            const int row = m->place[i[k]], column = m->place[c];
            m->j[next[row]] = column;
            m->x[next[row]++] = x[k];
            if (row == column) continue;
            m->j[next[column]] = row;
            m->x[next[column]++] = x[k];
        }
    }
    free(next);
    /* Places rise with equations but where vertices are split: sort what is not in order. */
    {
        struct entry { PetscInt j; double x; } *list = malloc(most*sizeof *list);
        if (!list) return LOPIN_NO_MEMORY;
        for (r = 0; r < m->rows; r++) {
            const PetscInt from = m->p[r], count = m->p[r + 1] - from;
            PetscInt q, sorted = 1;
            for (q = 1; q < count; q++) sorted = sorted && m->j[from + q] > m->j[from + q - 1];
            if (sorted) continue;
            for (q = 0; q < count; q++) {
                list[q].j = m->j[from + q];
                list[q].x = m->x[from + q];
            }
            qsort(list, count, sizeof *list, by_column);
            for (q = 0; q < count; q++) {
                m->j[from + q] = list[q].j;
                m->x[from + q] = list[q].x;
            }
        }
        free(list);
    }
    return LOPIN_OK;
}

/* What the coarse levels must hold: motions, orthonormal. */
static int set_motions(multigrid_type *m, int modes, const double *motion)
{
    Vec *vector;
    MatNullSpace space;
    PetscScalar *value, part[6];
    PetscReal length;
    int k, c, kept = 0;

    if (VecDuplicateVecs(m->right, modes, &vector)) return LOPIN_NO_MEMORY;
    for (k = 0; k < modes; k++) {
        VecSet(vector[kept], 0.0);
        VecGetArray(vector[kept], &value);
        for (c = 0; c < m->n; c++) value[m->place[c]] = motion[(size_t)k*m->n + c];
        VecRestoreArray(vector[kept], &value);
        VecNormalize(vector[kept], &length);
        if (!(length > 0.0)) continue;
        for (c = 0; c < 2 && kept > 0; c++) {
            int q;
            VecMDot(vector[kept], kept, vector, part);
            for (q = 0; q < kept; q++) part[q] = -part[q];
            VecMAXPY(vector[kept], kept, part, vector);
        }
        VecNormalize(vector[kept], &length);
        if (length > 1e-8) kept++;   /* a motion that the others hold is none */
    }
    if (kept > 0) {
        if (MatNullSpaceCreate(PETSC_COMM_SELF, PETSC_FALSE, kept, vector, &space)
            || MatSetNearNullSpace(m->matrix, space)) return LOPIN_FAILED;
        MatNullSpaceDestroy(&space);
    }
    VecDestroyVecs(modes, &vector);
    return LOPIN_OK;
}

static int set_up(multigrid_type *m, int block, int modes, const double *motion)
{
    PC pc;

    if (MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, m->rows, m->rows, m->p, m->j, m->x, &m->matrix)
        || MatSetBlockSize(m->matrix, block)
        || MatSetOption(m->matrix, MAT_SPD, PETSC_TRUE)
        || MatCreateVecs(m->matrix, &m->answer, &m->right)) return LOPIN_FAILED;
    if (set_motions(m, modes, motion)) return LOPIN_FAILED;
    if (KSPCreate(PETSC_COMM_SELF, &m->solver)
        || KSPSetOptionsPrefix(m->solver, "lopin_")
        || KSPSetOperators(m->solver, m->matrix, m->matrix)
        || KSPSetType(m->solver, KSPCG)
        || KSPSetNormType(m->solver, KSP_NORM_UNPRECONDITIONED)
        || KSPGetPC(m->solver, &pc)
        || PCSetType(pc, PCGAMG)
        || KSPSetFromOptions(m->solver)
        || KSPSetUp(m->solver)) return LOPIN_FAILED;
    return LOPIN_OK;
}

/* What the levels are worth shows when they are used: 1 if they are no use (a pivot that vanished). */
static int try_levels(multigrid_type *m)
{
    PCFailedReason failed = PC_NOERROR;
    PC pc;

    if (VecSet(m->right, 1.0) || KSPGetPC(m->solver, &pc) || PCApply(pc, m->right, m->answer)
        || PCGetFailedReason(pc, &failed)) return LOPIN_FAILED;
    return failed ? LOPIN_FAILED : LOPIN_OK;
}

int lopin_multigrid_create(void **handle, int n, int vertices, int block, const int *place,
                           int modes, const double *motion, const int *p, const int *i,
                           const double *x)
{
    multigrid_type *m;
    int status = start_petsc();

    *handle = 0;
    if (status) return status;
    if (vertices > PETSC_MAX_INT/block) return LOPIN_NO_MEMORY;
    m = calloc(1, sizeof *m);
    if (!m) return LOPIN_NO_MEMORY;
    m->n = n;
    m->rows = (PetscInt)vertices*block;
    m->place = malloc(n*sizeof *m->place);
    status = m->place ? LOPIN_OK : LOPIN_NO_MEMORY;
    if (!status) memcpy(m->place, place, n*sizeof *m->place);
    if (!status) status = fill_rows(m, p, i, x);
    if (!status) status = set_up(m, block, modes, motion);
    if (!status) status = try_levels(m);
    *handle = m;
    if (status) lopin_multigrid_free(handle);
    return status;
}

/* x <- an answer that leaves `tolerance` of x, or what `most` iterations give. */
int lopin_multigrid_solve(void *handle, double tolerance, int most, double *x, int *iterations)
{
    multigrid_type *m = handle;
    PetscScalar *value;
    const PetscScalar *found;
    PetscInt count = 0;
    KSPConvergedReason reason;
    int c;

    *iterations = 0;
    if (VecSet(m->right, 0.0) || VecGetArray(m->right, &value)) return LOPIN_FAILED;
    for (c = 0; c < m->n; c++) value[m->place[c]] = x[c];
    VecRestoreArray(m->right, &value);
    if (KSPSetTolerances(m->solver, tolerance, 0.0, PETSC_DEFAULT, most)
        || KSPSolve(m->solver, m->right, m->answer)) return LOPIN_FAILED;
    KSPGetIterationNumber(m->solver, &count);
    KSPGetConvergedReason(m->solver, &reason);
    *iterations = (int)count;
    VecGetArrayRead(m->answer, &found);
    for (c = 0; c < m->n; c++) x[c] = found[m->place[c]];
    VecRestoreArrayRead(m->answer, &found);
    return reason > 0 || reason == KSP_DIVERGED_ITS ? LOPIN_OK : LOPIN_FAILED;
}

#endif
