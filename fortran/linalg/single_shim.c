/* A factor in single precision on the symbolic analysis of CHOLMOD, and solutions with it.
 *
 * A preconditioner for iterations in double precision: half the memory and traffic of the double
 * factor, twice its speed. The matrix is scaled to a unit diagonal first, so that units do not
 * matter, and so that the square of a pivot of the factor is what elimination has left of it.
 * Negative pivots keep their sign; nothing is exchanged, so that a small pivot makes the factor
 * useless, which the ratio tells. Matrices are symmetric, lower triangle only, by columns, 0-based;
 * functions return 0 or 1: no use. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "supernodal.h"

enum { LOPIN_OK = 0, LOPIN_NO_USE = 1 };

extern void sgemv_(const char *, const int *, const int *, const float *, const float *,
                   const int *, const float *, const int *, const float *, float *, const int *);

extern void lopin_solve_forward(const float *, int, int, const float *, float *);
extern void lopin_solve_backward(const float *, int, int, const float *, float *);

extern int lopin_cholmod_plan(void *handle, const int *p, const int *i,
                              const supernodal_plan **plan);

typedef struct {
    const supernodal_plan *plan;
    float *x;                                 /* the factor, as CHOLMOD lays it out */
    double *scale;                            /* by equation, in the order of the factor */
    float *part, *y;                          /* of a solve */
    float *inverse;                           /* of the pivots, by column of the factor */
    signed char *sign;                        /* of the pivots, by column of the factor */
} single_type;

void lopin_single_free(void **out)
{
    single_type *h = *out;
    if (!h) return;
    free(h->x); free(h->scale); free(h->part); free(h->y); free(h->inverse); free(h->sign);
    free(h);
    *out = NULL;
}

/* Room for a factor; `handle` is that of CHOLMOD, analysed for the same pattern. */
int lopin_single_create(void **out, void *handle, const int *p, const int *i)
{
    const supernodal_plan *plan;
    single_type *h;
    size_t n;
    *out = NULL;
    if (lopin_cholmod_plan(handle, p, i, &plan) || !plan || !plan->n) return LOPIN_NO_USE;
    h = calloc(1, sizeof *h);
    if (!h) return LOPIN_NO_USE;
    *out = h;
    n = (size_t)plan->n;
    h->plan = plan;
    h->x = malloc(plan->px[plan->nsuper] * sizeof(float));
    h->scale = malloc(n * sizeof(double));
    h->part = malloc(((size_t)plan->most_rows + 1) * sizeof(float));
    h->y = malloc(n * sizeof(float));
    h->inverse = malloc(n * sizeof(float));
    h->sign = malloc(n);
    if (h->x && h->scale && h->part && h->y && h->inverse && h->sign) return LOPIN_OK;
    lopin_single_free(out);
    return LOPIN_NO_USE;
}

/* The matrix is to be scaled to a diagonal of size one. */
static int find_scale(single_type *h, const int *p, const int *i, const double *a, int signed_too)
{
    int k;
    for (k = 0; k < h->plan->n; k++) {
        int j = h->plan->perm[k];
        double diagonal = p[j] < p[j + 1] && i[p[j]] == j ? a[p[j]] : 0.0;
        if (signed_too) diagonal = fabs(diagonal);
        if (!(diagonal > 0.0) || isinf(diagonal)) return LOPIN_NO_USE;
        h->scale[k] = 1.0 / sqrt(diagonal);
    }
    return LOPIN_OK;
}

/* *ratio: the least of what elimination has left of a pivot; no use: a pivot vanishes, or one is
 * negative and the matrix is to be positive definite. */
int lopin_single_factorise(void *v, const int *p, const int *i, const double *a, int signed_too,
                           double *ratio, int *negative)
{
    single_type *h = v;
    const supernodal_plan *plan = h->plan;
    int failed, s, k;
    *ratio = 1.0;
    *negative = 0;
    if (find_scale(h, p, i, a, signed_too)) return LOPIN_NO_USE;
    if (lopin_factorise_single(plan, a, h->scale, h->x, signed_too, h->sign,
                               lopin_threads_of_run(), &failed))
        return LOPIN_NO_USE;
    for (s = 0; s < plan->nsuper; s++) {
        size_t rows = (size_t)(plan->pi[s + 1] - plan->pi[s]);
        for (k = plan->super[s]; k < plan->super[s + 1]; k++) {
            double l = h->x[plan->px[s] + (size_t)(k - plan->super[s]) * (rows + 1)];
            if (!(l * l < HUGE_VAL)) return LOPIN_NO_USE;    /* no number */
            if (l * l < *ratio) *ratio = l * l;
            h->inverse[k] = (float)(1.0 / l);
            *negative += h->sign[k] < 0;
        }
    }
    return *ratio == *ratio ? LOPIN_OK : LOPIN_NO_USE;
}

/* x <- A^-1 x, to single precision beside the largest of D^-1/2 x. */
void lopin_single_solve(void *v, double *x)
{
    single_type *h = v;
    const supernodal_plan *q = h->plan;
    const float one = 1.0f, minus = -1.0f, zero = 0.0f;
    const int step = 1;
    double most = 0.0;
    int k, s;
    for (k = 0; k < q->n; k++) {
        double own = fabs(x[q->perm[k]] * h->scale[k]);
        if (own > most) most = own;
    }
    if (!(most > 0.0)) return;
    for (k = 0; k < q->n; k++) h->y[k] = (float)(x[q->perm[k]] * h->scale[k] / most);
    for (s = 0; s < q->nsuper; s++) {
        const int *row = q->row + q->pi[s];
        int rows = q->pi[s + 1] - q->pi[s], columns = q->super[s + 1] - q->super[s];
        int below = rows - columns;
        const float *l = h->x + q->px[s];
        float *y = h->y + q->super[s];
        lopin_solve_forward(l, columns, rows, h->inverse + q->super[s], y);
        if (below <= 0) continue;
        sgemv_("N", &below, &columns, &one, l + columns, &rows, y, &step, &zero, h->part, &step);
        for (k = 0; k < below; k++) h->y[row[columns + k]] -= h->part[k];
    }
    for (k = 0; k < q->n; k++) h->y[k] *= (float)h->sign[k];
    for (s = q->nsuper - 1; s >= 0; s--) {
        const int *row = q->row + q->pi[s];
        int rows = q->pi[s + 1] - q->pi[s], columns = q->super[s + 1] - q->super[s];
        int below = rows - columns;
        const float *l = h->x + q->px[s];
        float *y = h->y + q->super[s];
        if (below > 0) {
            for (k = 0; k < below; k++) h->part[k] = h->y[row[columns + k]];
            sgemv_("C", &below, &columns, &minus, l + columns, &rows, h->part, &step, &one, y,
                   &step);
        }
        lopin_solve_backward(l, columns, rows, h->inverse + q->super[s], y);
    }
    for (k = 0; k < q->n; k++) x[q->perm[k]] = most * h->y[k] * h->scale[k];
}
