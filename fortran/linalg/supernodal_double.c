/* Supernodal factorisation in double precision. */
typedef double real;

extern void dsyrk_(const char *, const char *, const int *, const int *, const real *, const real *,
                   const int *, const real *, real *, const int *);
extern void dgemm_(const char *, const char *, const int *, const int *, const int *, const real *,
                   const real *, const int *, const real *, const int *, const real *, real *,
                   const int *);
extern void dtrsm_(const char *, const char *, const char *, const char *, const int *,
                   const int *, const real *, const real *, const int *, real *, const int *);
extern void dpotrf_(const char *, const int *, real *, const int *, int *);
#define syrk dsyrk_
#define gemm dgemm_
#define trsm dtrsm_
#define potrf dpotrf_

/* No negative pivots here. */
static void keep_block(real *x, int n, int rows, real *kept)
{
    (void)x; (void)n; (void)rows; (void)kept;
}
static void put_back(real *x, int n, int rows, const real *kept)
{
    (void)x; (void)n; (void)rows; (void)kept;
}
static void turn_columns(real *x, int columns, int n, int rows, const signed char *sign)
{
    (void)x; (void)columns; (void)n; (void)rows; (void)sign;
}
static int factorise_signed(real *x, int n, int rows, signed char *sign)
{
    (void)x; (void)n; (void)rows; (void)sign;
    return 0;
}

#include "supernodal_tiles.h"

int lopin_factorise_double(const supernodal_plan *plan, const double *a, double *x, int zero,
                           int threads, int *failed)
{
    factor_type f = {.plan = plan, .a = a, .x = x, .zero = zero};
    return factorise(&f, threads, failed);
}
