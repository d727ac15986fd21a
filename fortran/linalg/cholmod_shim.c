/* Opaque handle around CHOLMOD (int32 interface), so that Fortran never mirrors cholmod_common.
 *
 * Functions return 0 or a LOPIN_* code; they never exit and never print. Matrices are symmetric,
 * lower triangle only, by columns, 0-based, rows sorted. METIS and the thread count of the BLAS
 * are here too: both are C interfaces whose integer width or existence is known at compile time. */
#include <stdlib.h>
#include <string.h>
#include <cholmod.h>
#include <metis.h>

enum { LOPIN_OK = 0, LOPIN_NO_MEMORY = 1, LOPIN_NOT_POSITIVE = 2, LOPIN_TOO_LARGE = 3,
       LOPIN_OTHER = 4 };

typedef struct {
    cholmod_common c;
    cholmod_factor *L;
    cholmod_dense *X, *Y, *E;   /* workspaces of cholmod_solve2, kept between calls */
    size_t n;
} handle_type;

static int status_of(const handle_type *h)
{
    switch (h->c.status) {
    case CHOLMOD_NOT_POSDEF: return LOPIN_NOT_POSITIVE;
    case CHOLMOD_OUT_OF_MEMORY: return LOPIN_NO_MEMORY;
    case CHOLMOD_TOO_LARGE: return LOPIN_TOO_LARGE;
    default: return h->c.status >= 0 ? LOPIN_OK : LOPIN_OTHER;
    }
}

static cholmod_sparse sparse_view(size_t n, int *p, int *i, double *x, int sorted)
{
    cholmod_sparse a;
    memset(&a, 0, sizeof a);
    a.nrow = a.ncol = n;
    a.nzmax = (size_t)p[n];
    a.p = p; a.i = i; a.x = x;
    a.stype = -1;
    a.itype = CHOLMOD_INT;
    a.dtype = CHOLMOD_DOUBLE;
    a.xtype = x ? CHOLMOD_REAL : CHOLMOD_PATTERN;
    a.sorted = sorted;
    a.packed = 1;
    return a;
}

int lopin_cholmod_create(void **out)
{
    handle_type *h = calloc(1, sizeof *h);
    *out = h;
    if (!h) return LOPIN_NO_MEMORY;
    cholmod_start(&h->c);
    h->c.print = 0;
    h->c.error_handler = NULL;
    h->c.nmethods = 1;
    h->c.method[0].ordering = CHOLMOD_GIVEN;
    h->c.postorder = 0;                       /* the caller's permutation is already postordered */
    h->c.supernodal = CHOLMOD_SUPERNODAL;
    h->c.final_asis = 1;
    /* Wider supernodes than CHOLMOD's own choice: some more zeros, but fewer and larger matrix
     * products, measured 1.2 to 1.6 times faster (docs/solvers.md). */
    h->c.nrelax[0] = 32;
    h->c.nrelax[1] = 64;
    h->c.nrelax[2] = 128;
    h->c.zrelax[0] = 0.8;
    h->c.zrelax[1] = 0.3;
    h->c.zrelax[2] = 0.1;
    return LOPIN_OK;
}

void lopin_cholmod_free(void **out)
{
    handle_type *h = *out;
    if (!h) return;
    cholmod_free_factor(&h->L, &h->c);
    cholmod_free_dense(&h->X, &h->c);
    cholmod_free_dense(&h->Y, &h->c);
    cholmod_free_dense(&h->E, &h->c);
    cholmod_finish(&h->c);
    free(h);
    *out = NULL;
}

/* Approximate minimum degree of a graph by its strict lower triangle (p, i); perm[new] = old. */
int lopin_cholmod_amd(void *v, int n, int *p, int *i, int *perm)
{
    handle_type *h = v;
    cholmod_sparse a = sparse_view((size_t)n, p, i, NULL, 0);
    return cholmod_amd(&a, NULL, 0, perm, &h->c) ? status_of(h) : LOPIN_OTHER;
}

/* Elimination tree (parent[k], -1 at a root), column counts and cost of a permutation. */
int lopin_cholmod_tree(void *v, int n, int *p, int *i, int *perm, int *parent, int *count,
                       double *flops, double *entries)
{
    handle_type *h = v;
    cholmod_sparse a = sparse_view((size_t)n, p, i, NULL, 1);
    int *work = malloc(3 * (size_t)n * sizeof(int)), ok;
    if (!work) return LOPIN_NO_MEMORY;
    ok = cholmod_analyze_ordering(&a, CHOLMOD_GIVEN, perm, NULL, 0, parent, work, count,
                                  work + n, work + 2 * (size_t)n, &h->c);
    free(work);
    *flops = h->c.fl;
    *entries = h->c.lnz;
    return ok ? status_of(h) : (status_of(h) ? status_of(h) : LOPIN_OTHER);
}

int lopin_cholmod_analyse(void *v, int n, int *p, int *i, int *perm, long long *stored,
                          double *flops)
{
    handle_type *h = v;
    cholmod_sparse a = sparse_view((size_t)n, p, i, NULL, 1);
    cholmod_free_factor(&h->L, &h->c);
    cholmod_free_dense(&h->X, &h->c);
    cholmod_free_dense(&h->Y, &h->c);
    cholmod_free_dense(&h->E, &h->c);
    h->n = (size_t)n;
    h->L = cholmod_analyze_p(&a, perm, NULL, 0, &h->c);
    if (!h->L) return status_of(h) ? status_of(h) : LOPIN_OTHER;
    *stored = (long long)h->L->xsize;
    *flops = h->c.fl;
    return status_of(h);
}

/* The order and the supernodes, for factors of another precision (single_shim.c). */
const cholmod_factor *lopin_cholmod_symbolic(void *v)
{
    return v ? ((handle_type *)v)->L : NULL;
}

/* Smallest pivot over its own diagonal entry: *ratio, and its column of L: *where. */
static void weakest_pivot(const cholmod_factor *L, const int *p, const int *i, const double *a,
                          double *ratio, int *where)
{
    const int *super = L->super, *pi = L->pi, *px = L->px, *perm = L->Perm;
    const double *x = L->x;
    *ratio = 1.0;
    *where = 0;
    for (size_t s = 0; s < L->nsuper; s++) {
        size_t rows = (size_t)(pi[s + 1] - pi[s]);
        for (int j = super[s]; j < super[s + 1]; j++) {
            double l = x[(size_t)px[s] + (size_t)(j - super[s]) * (rows + 1)];
            int column = perm[j], k = p[column];
            double diagonal = k < p[column + 1] && i[k] == column ? a[k] : 0.0;
            double r = diagonal > 0.0 ? l * l / diagonal : 0.0;
            if (!(r >= *ratio)) { *ratio = r; *where = j; }
        }
    }
}

/* CHOLMOD starts four threads of its own in every larger supernode, whatever anybody asked for: they
 * spin between two loops of microseconds (a tenth of the CPU time of a factorisation). With no level
 * of parallel regions they are none; the threads of the BLAS are not those of OpenMP unless it says
 * so, and then it is left as it is. */
extern void omp_set_max_active_levels(int) __attribute__((weak));
extern int omp_get_max_active_levels(void) __attribute__((weak));
extern int openblas_get_parallel(void) __attribute__((weak));

static int without_levels(void)
{
    int levels;
    if (!omp_set_max_active_levels || !omp_get_max_active_levels) return -1;
    if (openblas_get_parallel && openblas_get_parallel() == 2) return -1;
    levels = omp_get_max_active_levels();
    omp_set_max_active_levels(0);
    return levels;
}

static void with_levels(int levels)
{
    if (levels >= 0) omp_set_max_active_levels(levels);
}

/* *where: 0-based equation of the failed (status LOPIN_NOT_POSITIVE) or weakest pivot. */
int lopin_cholmod_factorise(void *v, int *p, int *i, double *x, double *ratio, int *where)
{
    handle_type *h = v;
    cholmod_sparse a = sparse_view(h->n, p, i, x, 1);
    int status, levels, column = 0;
    *ratio = 0.0;
    *where = 0;
    if (!h->L) return LOPIN_OTHER;
    levels = without_levels();
    cholmod_factorize(&a, h->L, &h->c);
    with_levels(levels);
    status = status_of(h);
    if (status == LOPIN_NOT_POSITIVE) column = (int)h->L->minor;
    else if (status == LOPIN_OK) weakest_pivot(h->L, p, i, x, ratio, &column);
    if (h->n) *where = ((int *)h->L->Perm)[column];
    return status;
}

/* system: 0 A x = b; 4 L x = b and 5 L' x = b, both in the order of the factor. */
int lopin_cholmod_solve(void *v, int system, int columns, double *b, double *x)
{
    handle_type *h = v;
    cholmod_dense d;
    memset(&d, 0, sizeof d);
    d.nrow = d.d = h->n;
    d.ncol = (size_t)columns;
    d.nzmax = h->n * (size_t)columns;
    d.x = b;
    d.xtype = CHOLMOD_REAL;
    d.dtype = CHOLMOD_DOUBLE;
    if (!h->L) return LOPIN_OTHER;
    if (!cholmod_solve2(system, h->L, &d, NULL, &h->X, NULL, &h->Y, &h->E, &h->c))
        return status_of(h) ? status_of(h) : LOPIN_OTHER;
    memcpy(x, h->X->x, h->n * (size_t)columns * sizeof(double));
    return status_of(h);
}

/* Lower trailing block of the factor, t (last, last) by columns; zero above the diagonal. */
int lopin_cholmod_trailing(void *v, int last, double *t)
{
    handle_type *h = v;
    cholmod_factor *L = h->L;
    int first = (int)h->n - last;
    if (!L || !L->is_super) return LOPIN_OTHER;
    const int *super = L->super, *pi = L->pi, *px = L->px, *rows = L->s;
    const double *x = L->x;
    memset(t, 0, sizeof(double) * (size_t)last * (size_t)last);
    for (size_t k = 0; k < L->nsuper; k++) {
        size_t n = (size_t)(pi[k + 1] - pi[k]);
        const int *row = rows + pi[k];
        for (int j = super[k]; j < super[k + 1]; j++) {
            const double *column = x + px[k] + (size_t)(j - super[k]) * n;
            if (j < first) continue;
            for (size_t i = (size_t)(j - super[k]); i < n; i++)
                t[(size_t)(row[i] - first) + (size_t)(j - first) * (size_t)last] = column[i];
        }
    }
    return LOPIN_OK;
}

/* Nested dissection of a graph with weighted vertices, 0-based; perm[new] = old. */
int lopin_metis(int n, int *ptr, int *adjacent, int *weight, int *perm)
{
    int status = METIS_ERROR_MEMORY;
    if (sizeof(idx_t) == sizeof(int)) {
        idx_t count = n;
        int *inverse = malloc((size_t)n * sizeof(int) + 1);
        if (inverse)
            status = METIS_NodeND(&count, (idx_t *)ptr, (idx_t *)adjacent, (idx_t *)weight, NULL,
                                  (idx_t *)perm, (idx_t *)inverse);
        free(inverse);
    } else {
        size_t edges = (size_t)ptr[n], total = 4 * (size_t)n + 1 + edges;
        idx_t count = n, *w = malloc(total * sizeof *w);
        if (w) {
            idx_t *a = w + n + 1, *g = a + edges, *q = g + n, *inverse = q + n;
            for (int k = 0; k <= n; k++) w[k] = ptr[k];
            for (size_t k = 0; k < edges; k++) a[k] = adjacent[k];
            for (int k = 0; k < n; k++) g[k] = weight[k];
            status = METIS_NodeND(&count, w, a, g, NULL, q, inverse);
            for (int k = 0; k < n; k++) perm[k] = (int)q[k];
        }
        free(w);
    }
    return status == METIS_OK ? LOPIN_OK : LOPIN_OTHER;
}

/* Present in OpenBLAS only. */
extern void openblas_set_num_threads(int) __attribute__((weak));
extern int openblas_get_num_threads(void) __attribute__((weak));

int lopin_blas_threads_set(int n)
{
    if (!openblas_set_num_threads) return 0;
    openblas_set_num_threads(n);
    return 1;
}

/* 0: unknown. */
int lopin_blas_threads_now(void)
{
    return openblas_get_num_threads ? openblas_get_num_threads() : 0;
}
