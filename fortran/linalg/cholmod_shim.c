/* Opaque handle around CHOLMOD (int32 interface), so that Fortran never mirrors cholmod_common.
 *
 * Functions return 0 or a LOPIN_* code; they never exit and never print. Matrices are symmetric,
 * lower triangle only, by columns, 0-based, rows sorted. METIS and the thread count of the BLAS
 * are here too: both are C interfaces whose integer width or existence is known at compile time. */
#include <stdlib.h>
#include <string.h>
#include <cholmod.h>
#include <metis.h>
#include "supernodal.h"

enum { LOPIN_OK = 0, LOPIN_NO_MEMORY = 1, LOPIN_NOT_POSITIVE = 2, LOPIN_TOO_LARGE = 3,
       LOPIN_OTHER = 4 };

typedef struct {
    cholmod_common c;
    cholmod_factor *L;          /* the analysis alone */
    size_t n;
    supernodal_plan *plan;      /* of the factorisations, made with the first one */
    double *x;                  /* the factor */
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

static void forget(handle_type *h)
{
    lopin_supernodal_free(&h->plan);
    cholmod_free_factor(&h->L, &h->c);
    free(h->x);
    h->x = NULL;
}

void lopin_cholmod_free(void **out)
{
    handle_type *h = *out;
    if (!h) return;
    forget(h);
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
    forget(h);
    h->n = (size_t)n;
    /* As for SPQR: CHOLMOD lays out no factor then, which with short integers it refuses to do for
     * more than 2**31 entries. */
    h->L = cholmod_analyze_p2(CHOLMOD_ANALYZE_FOR_SPQR, &a, perm, NULL, 0, &h->c);
    if (!h->L) return status_of(h) ? status_of(h) : LOPIN_OTHER;
    *stored = h->L->is_super ? (long long)lopin_supernodal_entries(h->L) : 0;
    *flops = h->c.fl;
    return status_of(h);
}

/* The plan of factorisations of a matrix of this pattern; *plan NULL where there are no supernodes. */
int lopin_cholmod_plan(void *v, const int *p, const int *i, const supernodal_plan **plan)
{
    handle_type *h = v;
    int status = SUPERNODAL_OK;
    *plan = NULL;
    if (!h || !h->L || !h->L->is_super || !h->n) return LOPIN_OK;
    if (!h->plan) status = lopin_supernodal_plan(&h->plan, h->L, p, i);
    if (status) lopin_supernodal_free(&h->plan);
    *plan = h->plan;
    if (status == SUPERNODAL_TOO_LARGE) return LOPIN_TOO_LARGE;
    return status ? LOPIN_NO_MEMORY : LOPIN_OK;
}

/* Smallest pivot over its own diagonal entry: *ratio, and its column of L: *where. */
static void weakest_pivot(const supernodal_plan *plan, const double *x, const int *p,
                          const int *i, const double *a, double *ratio, int *where)
{
    *ratio = 1.0;
    *where = 0;
    for (int s = 0; s < plan->nsuper; s++) {
        size_t rows = (size_t)(plan->pi[s + 1] - plan->pi[s]);
        int first = plan->super[s];
        for (int j = first; j < plan->super[s + 1]; j++) {
            double l = x[plan->px[s] + (size_t)(j - first) * (rows + 1)];
            int column = plan->perm[j], k = p[column];
            double diagonal = k < p[column + 1] && i[k] == column ? a[k] : 0.0;
            double r = diagonal > 0.0 ? l * l / diagonal : 0.0;
            if (!(r >= *ratio)) { *ratio = r; *where = j; }
            if (r != r) return;               /* what is no number stays one */
        }
    }
}

static int factorise_supernodes(handle_type *h, const double *a, int *column)
{
    int zero = !h->x, status, failed;
    if (zero) h->x = calloc(h->plan->px[h->plan->nsuper], sizeof(double));
    if (!h->x) return LOPIN_NO_MEMORY;
    status = lopin_factorise_double(h->plan, a, h->x, zero, lopin_threads_of_run(), &failed);
    if (status == SUPERNODAL_NO_MEMORY) return LOPIN_NO_MEMORY;
    if (status == SUPERNODAL_OK) return LOPIN_OK;
    *column = failed;
    return LOPIN_NOT_POSITIVE;
}

/* *where: 0-based equation of the failed (status LOPIN_NOT_POSITIVE) or weakest pivot. */
int lopin_cholmod_factorise(void *v, int *p, int *i, double *x, double *ratio, int *where)
{
    handle_type *h = v;
    const supernodal_plan *plan;
    int status, column = 0;
    *ratio = 0.0;
    *where = 0;
    if (!h->L) return LOPIN_OTHER;
    if (!h->n) { *ratio = 1.0; return LOPIN_OK; }
    status = lopin_cholmod_plan(v, p, i, &plan);
    if (status) return status;
    if (!plan) return LOPIN_OTHER;
    status = factorise_supernodes(h, x, &column);
    if (status == LOPIN_OK) weakest_pivot(plan, h->x, p, i, x, ratio, &column);
    if (status == LOPIN_OK || status == LOPIN_NOT_POSITIVE) *where = plan->perm[column];
    return status;
}

/* `system` as lopin_supernodal_solve takes it; b and x may be one. */
int lopin_cholmod_solve(void *v, int system, int columns, double *b, double *x)
{
    handle_type *h = v;
    if (!h->plan || !h->x) return LOPIN_OTHER;
    return lopin_supernodal_solve(h->plan, h->x, system, columns, b, x) ? LOPIN_NO_MEMORY
                                                                        : LOPIN_OK;
}

/* Lower trailing block of the factor, t (last, last) by columns; zero above the diagonal. */
int lopin_cholmod_trailing(void *v, int last, double *t)
{
    handle_type *h = v;
    const supernodal_plan *plan = h->plan;
    int first = (int)h->n - last;
    if (!plan || !h->x) return LOPIN_OTHER;
    memset(t, 0, sizeof(double) * (size_t)last * (size_t)last);
    for (int k = 0; k < plan->nsuper; k++) {
        size_t n = (size_t)(plan->pi[k + 1] - plan->pi[k]);
        const int *row = plan->row + plan->pi[k];
        for (int j = plan->super[k]; j < plan->super[k + 1]; j++) {
            const double *column = h->x + plan->px[k] + (size_t)(j - plan->super[k]) * n;
            if (j < first) continue;
            for (size_t i = (size_t)(j - plan->super[k]); i < n; i++)
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
