/* Supernodal factor in single precision, on the symbolic analysis of CHOLMOD: L L^T or, of an
 * indefinite matrix where that is wanted, L S L^T with S of entries 1 and -1.
 *
 * A preconditioner for iterations in double precision: half the memory and traffic of the double
 * factor, twice its speed. The matrix is scaled to a unit diagonal first, so that units do not
 * matter, and so that the square of a pivot of the factor is what elimination has left of it. The
 * algorithm is the left-looking one of CHOLMOD (Chen, Davis, Hager and Rajamanickam 2008). Negative
 * pivots keep their sign; nothing is exchanged, so that a small pivot makes the factor useless, which
 * the ratio tells. Matrices are symmetric, lower triangle only, by columns, 0-based; functions return 0 or 1: no use. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <cholmod.h>

enum { LOPIN_OK = 0, LOPIN_NO_USE = 1 };

extern void ssyrk_(const char *, const char *, const int *, const int *, const float *,
                   const float *, const int *, const float *, float *, const int *);
extern void sgemm_(const char *, const char *, const int *, const int *, const int *,
                   const float *, const float *, const int *, const float *, const int *,
                   const float *, float *, const int *);
extern void strsm_(const char *, const char *, const char *, const char *, const int *,
                   const int *, const float *, const float *, const int *, float *, const int *);
extern void spotrf_(const char *, const int *, float *, const int *, int *);
extern void ssyr_(const char *, const int *, const float *, const float *, const int *, float *,
                  const int *);
extern void sgemv_(const char *, const int *, const int *, const float *, const float *,
                   const int *, const float *, const int *, const float *, float *, const int *);

extern void lopin_solve_forward(const float *, int, int, const float *, float *);
extern void lopin_solve_backward(const float *, int, int, const float *, float *);

extern const cholmod_factor *lopin_cholmod_symbolic(void *handle);

typedef struct {
    int n, nsuper;
    const int *super, *pi, *px, *row, *perm;  /* of the analysis, which outlives this */
    size_t size;                              /* entries of the factor */
    float *x;                                 /* the factor, as CHOLMOD lays it out */
    int *place;                               /* where each entry of the matrix goes in it */
    double *scale;                            /* by equation */
    int *work;                                /* 5 n + nsuper: of a factorisation */
    float *update, *part, *y;                 /* of a factorisation, of a solve */
    float *diagonal;                          /* of the block of a supernode, of a factorisation */
    float *inverse;                           /* of the pivots, by column of the factor */
    signed char *sign;                        /* of the pivots, by column of the factor */
    int negative;                             /* pivots below zero */
} single_type;

void lopin_single_free(void **out)
{
    single_type *h = *out;
    if (!h) return;
    free(h->x); free(h->place); free(h->scale); free(h->work); free(h->update); free(h->part);
    free(h->y); free(h->diagonal); free(h->inverse); free(h->sign); free(h);
    *out = NULL;
}

static int position_in(const int *row, int n, int r)
{
    int low = 0;
    while (n > 1) {
        int half = n / 2;
        if (row[low + half] <= r) { low += half; n -= half; }
        else n = half;
    }
    return row[low] == r ? low : -1;
}

/* Where the entries of a matrix go; `handle` is that of CHOLMOD, analysed for the same pattern. */
int lopin_single_create(void **out, void *handle, const int *p, const int *i)
{
    const cholmod_factor *L = lopin_cholmod_symbolic(handle);
    single_type *h;
    int *inverse, *owner, s, j, k;
    *out = NULL;
    if (!L || !L->is_super || !L->n) return LOPIN_NO_USE;
    h = calloc(1, sizeof *h);
    if (!h) return LOPIN_NO_USE;
    *out = h;
    h->n = (int)L->n;
    h->nsuper = (int)L->nsuper;
    h->super = L->super; h->pi = L->pi; h->px = L->px; h->row = L->s; h->perm = L->Perm;
    h->size = L->xsize;
    h->x = malloc(L->xsize * sizeof(float));
    h->place = malloc((size_t)p[h->n] * sizeof(int) + 1);
    h->scale = malloc((size_t)h->n * sizeof(double));
    h->work = malloc((5 * (size_t)h->n + (size_t)h->nsuper) * sizeof(int));
    h->update = malloc((L->maxcsize + 1) * sizeof(float));
    h->part = malloc((L->maxesize + 1) * sizeof(float));
    h->y = malloc((size_t)h->n * sizeof(float));
    h->diagonal = malloc((size_t)h->n * sizeof(float));
    h->inverse = malloc((size_t)h->n * sizeof(float));
    h->sign = malloc((size_t)h->n);
    if (!h->x || !h->place || !h->scale || !h->work || !h->update || !h->part || !h->y
        || !h->diagonal || !h->inverse || !h->sign) {
        lopin_single_free(out);
        return LOPIN_NO_USE;
    }
    owner = h->work;                          /* stays */
    inverse = h->work + h->n;
    for (s = 0; s < h->nsuper; s++)
        for (k = h->super[s]; k < h->super[s + 1]; k++) owner[k] = s;
    for (k = 0; k < h->n; k++) inverse[h->perm[k]] = k;
    for (j = 0; j < h->n; j++)
        for (k = p[j]; k < p[j + 1]; k++) {
            int a = inverse[i[k]], b = inverse[j], c = a < b ? a : b, r = a < b ? b : a, at;
            s = owner[c];
            at = position_in(h->row + h->pi[s], h->pi[s + 1] - h->pi[s], r);
            if (at < 0) { lopin_single_free(out); return LOPIN_NO_USE; }
            h->place[k] = h->px[s] + (c - h->super[s]) * (h->pi[s + 1] - h->pi[s]) + at;
        }
    return LOPIN_OK;
}

/* The values of the matrix, scaled to a diagonal of size one. */
static int fill(single_type *h, const int *p, const int *i, const double *a, int signed_too)
{
    int j, k;
    for (j = 0; j < h->n; j++) {
        double diagonal = p[j] < p[j + 1] && i[p[j]] == j ? a[p[j]] : 0.0;
        if (signed_too) diagonal = fabs(diagonal);
        if (!(diagonal > 0.0) || isinf(diagonal)) return LOPIN_NO_USE;
        h->scale[j] = 1.0 / sqrt(diagonal);
    }
    memset(h->x, 0, h->size * sizeof(float));
    for (j = 0; j < h->n; j++)
        for (k = p[j]; k < p[j + 1]; k++)
            h->x[h->place[k]] = (float)(a[k] * h->scale[i[k]] * h->scale[j]);
    return LOPIN_OK;
}

/* Columns of negative pivots change their sign: the rows below them are B L^-T S. */
static void turn_columns(float *x, int columns, int n, int rows, const signed char *sign)
{
    int i, k;
    for (k = 0; k < columns; k++)
        if (sign[k] < 0)
            for (i = 0; i < n; i++) x[(size_t)k * (size_t)rows + (size_t)i] *= -1.0f;
}

/* What columns of negative pivots give counts the other way: twice is taken back. */
static void turn_update(single_type *h, int d, const float *x, int n, int m)
{
    int rows = h->pi[d + 1] - h->pi[d], columns = h->super[d + 1] - h->super[d], i, j, k;
    for (k = 0; k < columns; k++) {
        const float *l = x + (size_t)k * (size_t)rows;
        if (h->sign[h->super[d] + k] > 0) continue;
        for (j = 0; j < n; j++) {
            float *c = h->update + (size_t)j * (size_t)m, twice = 2.0f * l[j];
            for (i = j; i < m; i++) c[i] -= twice * l[i];
        }
    }
}

/* Keep the lower half of a block in its upper half, which nothing else uses; and put it back. */
static void keep_block(float *x, int n, int rows, float *diagonal)
{
    int i, j;
    for (j = 0; j < n; j++) {
        diagonal[j] = x[(size_t)j * ((size_t)rows + 1)];
        for (i = j + 1; i < n; i++)
            x[(size_t)i * (size_t)rows + (size_t)j] = x[(size_t)j * (size_t)rows + (size_t)i];
    }
}

static void put_back(float *x, int n, int rows, const float *diagonal)
{
    int i, j;
    for (j = 0; j < n; j++) {
        x[(size_t)j * ((size_t)rows + 1)] = diagonal[j];
        for (i = j + 1; i < n; i++)
            x[(size_t)j * (size_t)rows + (size_t)i] = x[(size_t)i * (size_t)rows + (size_t)j];
    }
}

/* L S L^T of a few columns, in place; 0: a pivot vanishes. */
static int factorise_columns(float *x, int n, int rows, signed char *sign)
{
    int i, j, k;
    for (k = 0; k < n; k++) {
        float *own = x + (size_t)k * (size_t)rows, pivot = own[k], root = sqrtf(fabsf(pivot));
        if (!(root > 0.0f) || isinf(root)) return 0;
        sign[k] = pivot > 0.0f ? 1 : -1;
        own[k] = root;
        for (i = k + 1; i < n; i++) own[i] /= (float)sign[k] * root;
        for (j = k + 1; j < n; j++) {
            float *next = x + (size_t)j * (size_t)rows, part = (float)sign[k] * own[j];
            for (i = j; i < n; i++) next[i] -= part * own[i];
        }
    }
    return 1;
}

/* L S L^T of the block of a supernode, in place. */
static int factorise_signed(float *x, int n, int rows, signed char *sign)
{
    enum { AT_A_TIME = 32 };
    const float one = 1.0f, minus = -1.0f, two = 2.0f;
    const int step = 1;
    int first, k;
    for (first = 0; first < n; first += AT_A_TIME) {
        int m = n - first < AT_A_TIME ? n - first : AT_A_TIME, below = n - first - m;
        float *own = x + (size_t)first * ((size_t)rows + 1), *panel = own + m;
        float *rest = own + (size_t)m * ((size_t)rows + 1);
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

/* Take from supernode s what its descendant d gives; the descendant's next rows begin at `at`. */
static int take_descendant(single_type *h, int s, int d, int at, const int *map, int *relative)
{
    const float one = 1.0f, zero = 0.0f;
    const int *row = h->row + h->pi[d];
    int rows = h->pi[d + 1] - h->pi[d], columns = h->super[d + 1] - h->super[d], end, n, m, i, j;
    int ns = h->pi[s + 1] - h->pi[s], below;
    const float *x = h->x + h->px[d] + at;
    float *target = h->x + h->px[s];
    for (end = at; end < rows && row[end] < h->super[s + 1]; end++) ;
    n = end - at;
    m = rows - at;
    below = m - n;
    ssyrk_("L", "N", &n, &columns, &one, x, &rows, &zero, h->update, &m);
    if (below > 0)
        sgemm_("N", "C", &below, &n, &columns, &one, x + n, &rows, x, &rows, &zero,
               h->update + n, &m);
    if (h->negative) turn_update(h, d, x, n, m);
    for (i = 0; i < m; i++) relative[i] = map[row[at + i]];
    for (j = 0; j < n; j++) {
        const float *c = h->update + (size_t)j * (size_t)m;
        float *t = target + (size_t)relative[j] * (size_t)ns;
        for (i = j; i < m; i++) t[relative[i]] -= c[i];
    }
    return end;
}

/* The factor of the block of a supernode. */
static int factorise_block(single_type *h, int s, int signed_too)
{
    int rows = h->pi[s + 1] - h->pi[s], columns = h->super[s + 1] - h->super[s], status, k;
    float *x = h->x + h->px[s];
    if (signed_too) keep_block(x, columns, rows, h->diagonal);
    spotrf_("L", &columns, x, &rows, &status);
    if (!status) return LOPIN_OK;
    if (!signed_too) return LOPIN_NO_USE;
    put_back(x, columns, rows, h->diagonal);
    if (!factorise_signed(x, columns, rows, h->sign + h->super[s])) return LOPIN_NO_USE;
    for (k = h->super[s]; k < h->super[s + 1]; k++) h->negative += h->sign[k] < 0;
    return LOPIN_OK;
}

/* *ratio: the least of what elimination has left of a pivot; no use: a pivot vanishes, or one is
 * negative and the matrix is to be positive definite. */
int lopin_single_factorise(void *v, const int *p, const int *i, const double *a, int signed_too,
                           double *ratio, int *negative)
{
    single_type *h = v;
    const float one = 1.0f;
    int *owner = h->work, *map = owner + h->n, *relative = map + h->n, *next = relative + h->n;
    int *at = next + h->n, *head = at + h->n, s, d, follow, k;
    *ratio = 1.0;
    h->negative = 0;
    memset(h->sign, 1, (size_t)h->n);
    if (fill(h, p, i, a, signed_too)) return LOPIN_NO_USE;
    for (s = 0; s < h->nsuper; s++) head[s] = -1;
    for (s = 0; s < h->nsuper; s++) {
        const int *row = h->row + h->pi[s];
        int rows = h->pi[s + 1] - h->pi[s], columns = h->super[s + 1] - h->super[s];
        int below = rows - columns;
        float *x = h->x + h->px[s];
        for (k = 0; k < rows; k++) map[row[k]] = k;
        for (d = head[s]; d >= 0; d = follow) {
            follow = next[d];
            at[d] = take_descendant(h, s, d, at[d], map, relative);
            if (at[d] < h->pi[d + 1] - h->pi[d]) {
                k = owner[h->row[h->pi[d] + at[d]]];
                next[d] = head[k];
                head[k] = d;
            }
        }
        if (factorise_block(h, s, signed_too)) return LOPIN_NO_USE;
        for (k = 0; k < columns; k++) {
            double l = x[(size_t)k * ((size_t)rows + 1)];
            if (!(l * l >= *ratio)) *ratio = l * l;
            h->inverse[h->super[s] + k] = (float)(1.0 / l);
        }
        if (below <= 0) continue;
        strsm_("R", "L", "C", "N", &below, &columns, &one, x, &rows, x + columns, &rows);
        if (h->negative) turn_columns(x + columns, columns, below, rows, h->sign + h->super[s]);
        at[s] = columns;
        k = owner[row[columns]];
        next[s] = head[k];
        head[k] = s;
    }
    *negative = h->negative;
    return *ratio == *ratio ? LOPIN_OK : LOPIN_NO_USE;
}

/* x <- A^-1 x, to single precision beside the largest of D^-1/2 x. */
void lopin_single_solve(void *v, double *x)
{
    single_type *h = v;
    const float one = 1.0f, minus = -1.0f, zero = 0.0f;
    const int step = 1;
    double most = 0.0;
    int k, s;
    for (k = 0; k < h->n; k++) {
        double own = fabs(x[k] * h->scale[k]);
        if (own > most) most = own;
    }
    if (!(most > 0.0)) return;
    for (k = 0; k < h->n; k++) h->y[k] = (float)(x[h->perm[k]] * h->scale[h->perm[k]] / most);
    for (s = 0; s < h->nsuper; s++) {
        const int *row = h->row + h->pi[s];
        int rows = h->pi[s + 1] - h->pi[s], columns = h->super[s + 1] - h->super[s];
        int below = rows - columns;
        const float *l = h->x + h->px[s];
        float *y = h->y + h->super[s];
        lopin_solve_forward(l, columns, rows, h->inverse + h->super[s], y);
        if (below <= 0) continue;
        sgemv_("N", &below, &columns, &one, l + columns, &rows, y, &step, &zero, h->part, &step);
        for (k = 0; k < below; k++) h->y[row[columns + k]] -= h->part[k];
    }
    for (k = 0; k < h->n; k++) h->y[k] *= (float)h->sign[k];
    for (s = h->nsuper - 1; s >= 0; s--) {
        const int *row = h->row + h->pi[s];
        int rows = h->pi[s + 1] - h->pi[s], columns = h->super[s + 1] - h->super[s];
        int below = rows - columns;
        const float *l = h->x + h->px[s];
        float *y = h->y + h->super[s];
        if (below > 0) {
            for (k = 0; k < below; k++) h->part[k] = h->y[row[columns + k]];
            sgemv_("C", &below, &columns, &minus, l + columns, &rows, h->part, &step, &one, y,
                   &step);
        }
        lopin_solve_backward(l, columns, rows, h->inverse + h->super[s], y);
    }
    for (k = 0; k < h->n; k++) x[h->perm[k]] = most * h->y[k] * h->scale[h->perm[k]];
}
