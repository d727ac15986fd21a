/* Supernodal factorisation in single precision: L L^T or, of an indefinite matrix where that is
 * wanted, L S L^T with S of entries 1 and -1. */
#include <math.h>
#include <stddef.h>

typedef float real;

extern void ssyrk_(const char *, const char *, const int *, const int *, const real *, const real *,
                   const int *, const real *, real *, const int *);
extern void sgemm_(const char *, const char *, const int *, const int *, const int *, const real *,
                   const real *, const int *, const real *, const int *, const real *, real *,
                   const int *);
extern void strsm_(const char *, const char *, const char *, const char *, const int *,
                   const int *, const real *, const real *, const int *, real *, const int *);
extern void spotrf_(const char *, const int *, real *, const int *, int *);
extern void ssyr_(const char *, const int *, const real *, const real *, const int *, real *,
                  const int *);
#define syrk ssyrk_
#define gemm sgemm_
#define trsm strsm_
#define potrf spotrf_

/* Columns of negative pivots change their sign: the rows below them are B L^-T S. */
static void turn_columns(real *x, int columns, int n, int rows, const signed char *sign)
{
    int i, k;
    for (k = 0; k < columns; k++)
        if (sign[k] < 0)
            for (i = 0; i < n; i++) x[(size_t)k * (size_t)rows + (size_t)i] *= -1;
}

/* Keep the lower half of a block in its upper half, which nothing else uses; and put it back. */
static void keep_block(real *x, int n, int rows, real *diagonal)
{
    int i, j;
    for (j = 0; j < n; j++) {
        diagonal[j] = x[(size_t)j * ((size_t)rows + 1)];
        for (i = j + 1; i < n; i++)
            x[(size_t)i * (size_t)rows + (size_t)j] = x[(size_t)j * (size_t)rows + (size_t)i];
    }
}

static void put_back(real *x, int n, int rows, const real *diagonal)
{
    int i, j;
    for (j = 0; j < n; j++) {
        x[(size_t)j * ((size_t)rows + 1)] = diagonal[j];
        for (i = j + 1; i < n; i++)
            x[(size_t)j * (size_t)rows + (size_t)i] = x[(size_t)i * (size_t)rows + (size_t)j];
    }
}

/* L S L^T of a few columns, in place; 0: a pivot vanishes. */
static int factorise_columns(real *x, int n, int rows, signed char *sign)
{
    int i, j, k;
    for (k = 0; k < n; k++) {
        real *own = x + (size_t)k * (size_t)rows, pivot = own[k], root = sqrtf(fabsf(pivot));
        if (!(root > 0.0f) || isinf(root)) return 0;
        sign[k] = pivot > 0.0f ? 1 : -1;
        own[k] = root;
        for (i = k + 1; i < n; i++) own[i] /= (real)sign[k] * root;
        for (j = k + 1; j < n; j++) {
            real *next = x + (size_t)j * (size_t)rows, part = (real)sign[k] * own[j];
            for (i = j; i < n; i++) next[i] -= part * own[i];
        }
    }
    return 1;
}

/* L S L^T of the block of a supernode, in place. */
static int factorise_signed(real *x, int n, int rows, signed char *sign)
{
    enum { AT_A_TIME = 32 };
    const real one = 1.0f, minus = -1.0f, two = 2.0f;
    const int step = 1;
    int first, k;
    for (first = 0; first < n; first += AT_A_TIME) {
        int m = n - first < AT_A_TIME ? n - first : AT_A_TIME, below = n - first - m;
        real *own = x + (size_t)first * ((size_t)rows + 1), *panel = own + m;
        real *rest = own + (size_t)m * ((size_t)rows + 1);
        if (!factorise_columns(own, m, rows, sign + first)) return 0;
        if (below <= 0) continue;
        strsm_("R", "L", "C", "N", &below, &m, &one, own, &rows, panel, &rows);
        ssyrk_("L", "N", &below, &m, &minus, panel, &rows, &one, rest, &rows);
        for (k = 0; k < m; k++)
            if (sign[first + k] < 0)
                ssyr_("L", &below, &two, panel + (size_t)k * (size_t)rows, &step, rest, &rows);
        turn_columns(panel, m, below, rows, sign + first);
    }
    return 1;
}

#include "supernodal_tiles.h"

int lopin_factorise_single(const supernodal_plan *plan, const double *a, const double *scale,
                           float *x, int signed_too, signed char *sign, int threads, int *failed)
{
    factor_type f = {.plan = plan, .a = a, .scale = scale, .x = x, .sign = sign,
                     .signed_too = signed_too};
    memset(sign, 1, (size_t)plan->n);
    return factorise(&f, threads, failed);
}
