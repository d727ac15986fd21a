/* Solutions with a supernodal factor in double precision, of one right-hand side or many. */
#include <stdlib.h>
#include <string.h>
#include "every_processor.h"
#include "supernodal.h"

enum { PARTS = 4, AT_A_TIME = 4 };
typedef double parts_type __attribute__((vector_size(PARTS * sizeof(double))));

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

/* z <- L^-T z of one supernode of `rows` rows and `columns` columns: below its triangle z is known.
 * The pass waits for the factor to come from memory: it is read once, four columns at a time, and
 * the four columns that follow are asked for ahead. The order of the sums is that of the text on
 * every processor, and nothing is fused. */
FOR_EACH_PROCESSOR
static void solve_supernode(const double *restrict l, int columns, int rows, double *restrict z)
{
    const ptrdiff_t ahead = (ptrdiff_t)AT_A_TIME * rows;
    int i, j, k, m, tail = columns % AT_A_TIME;
    for (j = columns - 1; j >= columns - tail; j--) {
        const double *a = l + (size_t)j * (size_t)rows;
        parts_type sum = {0.0}, own, of_z;
        double s;
        for (i = j + 1; i + PARTS <= rows; i += PARTS) {
            memcpy(&of_z, z + i, sizeof of_z);
            memcpy(&own, a + i, sizeof own);
            sum += own * of_z;
        }
        s = (sum[0] + sum[2]) + (sum[1] + sum[3]);
        for (; i < rows; i++) s += a[i] * z[i];
        z[j] = (z[j] - s) / a[j];
    }
    for (j = columns - tail - AT_A_TIME; j >= 0; j -= AT_A_TIME) {
        const double *a = l + (size_t)j * (size_t)rows, *b = a + rows, *c = b + rows, *d = c + rows;
        const double *column[AT_A_TIME] = {a, b, c, d};
        parts_type of_a = {0.0}, of_b = {0.0}, of_c = {0.0}, of_d = {0.0}, own, of_z;
        double s[AT_A_TIME];
        for (i = j + AT_A_TIME; i + PARTS <= rows; i += PARTS) {
            FETCH(a + i - ahead);
            FETCH(b + i - ahead);
            FETCH(c + i - ahead);
            FETCH(d + i - ahead);
            memcpy(&of_z, z + i, sizeof of_z);
            memcpy(&own, a + i, sizeof own);
            of_a += own * of_z;
            memcpy(&own, b + i, sizeof own);
            of_b += own * of_z;
            memcpy(&own, c + i, sizeof own);
            of_c += own * of_z;
            memcpy(&own, d + i, sizeof own);
            of_d += own * of_z;
        }
        s[0] = (of_a[0] + of_a[2]) + (of_a[1] + of_a[3]);
        s[1] = (of_b[0] + of_b[2]) + (of_b[1] + of_b[3]);
        s[2] = (of_c[0] + of_c[2]) + (of_c[1] + of_c[3]);
        s[3] = (of_d[0] + of_d[2]) + (of_d[1] + of_d[3]);
        for (k = 0; k < AT_A_TIME; k++)
            for (m = i; m < rows; m++) s[k] += column[k][m] * z[m];
        for (k = AT_A_TIME - 1; k >= 0; k--) {
            for (m = k + 1; m < AT_A_TIME; m++) s[k] += column[k][j + m] * z[j + m];
            z[j + k] = (z[j + k] - s[k]) / column[k][j + k];
        }
    }
}

/* y (n) <- L^-T y; z: room for the rows of a supernode. */
static void backward_one(const supernodal_plan *h, const double *x, double *y, double *z)
{
    for (int s = h->nsuper - 1; s >= 0; s--) {
        block_type b = block_of(h, x, s);
        double *top = y + h->super[s];
        memcpy(z, top, (size_t)b.columns * sizeof *z);
        take(&b, h->n, 1, y, z + b.columns, 0);
        solve_supernode(b.l, b.columns, b.rows, z);
        memcpy(top, z, (size_t)b.columns * sizeof *z);
    }
}

/* y (n, m) <- L^-T y. */
static void backward(const supernodal_plan *h, const double *x, int m, double *y, double *part)
{
    const int n = h->n;
    if (m == 1) {
        backward_one(h, x, y, part);
        return;
    }
    for (int s = h->nsuper - 1; s >= 0; s--) {
        block_type b = block_of(h, x, s);
        double *top = y + h->super[s];
        if (b.below) {
            take(&b, n, m, y, part, 0);
            dgemm_("C", "N", &b.columns, &m, &b.below, &minus, b.under, &b.rows, part, &b.below,
                   &one, top, &n);
        }
        dtrsm_("L", "L", "C", "N", &b.columns, &m, &one, b.l, &b.rows, top, &n);
    }
}

int lopin_supernodal_solve(const supernodal_plan *plan, const double *x, int system, int columns,
                           const double *b, double *out)
{
    size_t n = (size_t)plan->n, m = (size_t)columns;
    if (system != CHOLMOD_A && m == 1) {
        double *part = malloc((size_t)plan->most_rows * sizeof(double) + 1);
        if (!part) return SUPERNODAL_NO_MEMORY;
        if (out != b) memcpy(out, b, n * sizeof(double));
        if (system == CHOLMOD_L) forward(plan, x, 1, out, part);
        else backward(plan, x, 1, out, part);
        free(part);
        return SUPERNODAL_OK;
    }
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
