/* Solutions with a supernodal factor in double precision, of one right-hand side or many. */
#include <stdlib.h>
#include "supernodal.h"

extern void dtrsv_(const char *, const char *, const char *, const int *, const double *,
                   const int *, double *, const int *);
extern void dtrsm_(const char *, const char *, const char *, const char *, const int *,
                   const int *, const double *, const double *, const int *, double *,
                   const int *);
extern void dgemv_(const char *, const int *, const int *, const double *, const double *,
                   const int *, const double *, const int *, const double *, double *, const int *);
extern void dgemm_(const char *, const char *, const int *, const int *, const int *,
                   const double *, const double *, const int *, const double *, const int *,
                   const double *, double *, const int *);

static const double one = 1.0, minus = -1.0;
static const int step = 1;

/* A supernode: its block on the diagonal, what is below it, and the rows of that. */
typedef struct { int rows, columns, below; const double *l, *under; const int *row; } block_type;

static block_type block_of(const supernodal_plan *h, const double *x, int s)
{
    block_type b;
    b.rows = h->pi[s + 1] - h->pi[s];
    b.columns = h->super[s + 1] - h->super[s];
    b.below = b.rows - b.columns;
    b.l = x + h->px[s];
    b.under = b.l + b.columns;
    b.row = h->row + h->pi[s] + b.columns;
    return b;
}

/* Rows below a supernode out of y (n, m) into part (below, m), or back. */
static void take(const block_type *b, int n, int m, double *y, double *part, int back)
{
    for (int j = 0; j < m; j++) {
        double *whole = y + (size_t)j * (size_t)n, *own = part + (size_t)j * (size_t)b->below;
        if (back) for (int k = 0; k < b->below; k++) whole[b->row[k]] = own[k];
        else for (int k = 0; k < b->below; k++) own[k] = whole[b->row[k]];
    }
}

/* y (n, m) <- L^-1 y. */
static void forward(const supernodal_plan *h, const double *x, int m, double *y, double *part)
{
    const int n = h->n;
    for (int s = 0; s < h->nsuper; s++) {
        block_type b = block_of(h, x, s);
        double *top = y + h->super[s];
        if (m == 1) dtrsv_("L", "N", "N", &b.columns, b.l, &b.rows, top, &step);
        else dtrsm_("L", "L", "N", "N", &b.columns, &m, &one, b.l, &b.rows, top, &n);
        if (!b.below) continue;
        take(&b, n, m, y, part, 0);
        if (m == 1)
            dgemv_("N", &b.below, &b.columns, &minus, b.under, &b.rows, top, &step, &one, part,
                   &step);
        else
            dgemm_("N", "N", &b.below, &m, &b.columns, &minus, b.under, &b.rows, top, &n, &one,
                   part, &b.below);
        take(&b, n, m, y, part, 1);
    }
}

/* y (n, m) <- L^-T y. */
static void backward(const supernodal_plan *h, const double *x, int m, double *y, double *part)
{
    const int n = h->n;
    for (int s = h->nsuper - 1; s >= 0; s--) {
        block_type b = block_of(h, x, s);
        double *top = y + h->super[s];
        if (b.below) {
            take(&b, n, m, y, part, 0);
            if (m == 1)
                dgemv_("C", &b.below, &b.columns, &minus, b.under, &b.rows, part, &step, &one, top,
                       &step);
            else
                dgemm_("C", "N", &b.columns, &m, &b.below, &minus, b.under, &b.rows, part,
                       &b.below, &one, top, &n);
        }
        if (m == 1) dtrsv_("L", "C", "N", &b.columns, b.l, &b.rows, top, &step);
        else dtrsm_("L", "L", "C", "N", &b.columns, &m, &one, b.l, &b.rows, top, &n);
    }
}

int lopin_supernodal_solve(const supernodal_plan *plan, const double *x, int system, int columns,
                           const double *b, double *out)
{
    size_t n = (size_t)plan->n, m = (size_t)columns;
    double *y = malloc((n + (size_t)plan->most_rows) * m * sizeof(double) + 1);
    if (!y) return SUPERNODAL_NO_MEMORY;
    for (size_t j = 0; j < m; j++)
        for (size_t k = 0; k < n; k++)
            y[j * n + k] = b[j * n + (system == CHOLMOD_A ? (size_t)plan->perm[k] : k)];
    if (system != CHOLMOD_Lt) forward(plan, x, columns, y, y + n * m);
    if (system != CHOLMOD_L) backward(plan, x, columns, y, y + n * m);
    for (size_t j = 0; j < m; j++)
        for (size_t k = 0; k < n; k++)
            out[j * n + (system == CHOLMOD_A ? (size_t)plan->perm[k] : k)] = y[j * n + k];
    free(y);
    return SUPERNODAL_OK;
}
