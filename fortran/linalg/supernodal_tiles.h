/* Supernodal factorisation by tiles, for the precision that the includer names: `real`, the BLAS
 * as `gemm`, `syrk`, `trsm`, `potrf`, and what blocks with negative pivots need (`keep_block`,
 * `put_back`, `factorise_signed`, `turn_columns`).
 *
 * Left-looking (Ng and Peyton 1993): a supernode takes what its descendants give, then is
 * factorised itself. Its columns are cut into strips of TILE, its rows into runs of TILE: a tile is
 * what one thread does at a time. What a descendant gives goes straight to its place where its rows
 * lie side by side there. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "supernodal.h"

enum { TILE = 512 };

/* Products from which a second thread is started: some tenth of a second. */
static const double WORTH_A_THREAD = 1e9;

static const real one = 1, minus = -1, zero = 0;

typedef struct {
    const supernodal_plan *plan;
    const double *a, *scale;                  /* scale: NULL for none */
    real *x;
    signed char *sign;                        /* (n) of pivots, where signs are wanted */
    int zero, signed_too;
    int *next, *at, *head;                    /* (nsuper) lists of descendants */
    int *negative;                            /* (nsuper) negative pivots */
    struct own *own;                          /* by thread; lists and map of the top: the first */
} factor_type;

/* What a thread has for itself. */
typedef struct own {
    int status, failed;                       /* failed: first column without a pivot, or -1 */
    real *update;                             /* (TILE, TILE) */
    real *kept;                               /* (TILE) */
    int *map;                                 /* (n) row of the supernode in hand */
    int *relative;                            /* (TILE) */
    int n, *from, *begin, *end;               /* (nsuper) descendants, their rows in the columns */
} own_type;

static void free_own(own_type *w)
{
    free(w->update); free(w->map); free(w->from);
}

static int make_own(own_type *w, const supernodal_plan *h)
{
    size_t most = (size_t)h->nsuper + 1;
    w->update = malloc(((size_t)TILE + 1) * TILE * sizeof(real));
    w->map = malloc(((size_t)h->n + TILE) * sizeof(int));
    w->from = malloc(3 * most * sizeof(int));
    if (!w->update || !w->map || !w->from) return SUPERNODAL_NO_MEMORY;
    w->kept = w->update + (size_t)TILE * TILE;
    w->relative = w->map + h->n;
    w->begin = w->from + most;
    w->end = w->begin + most;
    return SUPERNODAL_OK;
}

static int rows_of(const supernodal_plan *h, int s) { return h->pi[s + 1] - h->pi[s]; }
static int columns_of(const supernodal_plan *h, int s) { return h->super[s + 1] - h->super[s]; }
static int least(int a, int b) { return a < b ? a : b; }
static int most(int a, int b) { return a > b ? a : b; }

/* Entries of the matrix that supernode s begins with. */
static void fill(factor_type *f, int s)
{
    const supernodal_plan *h = f->plan;
    real *x = f->x + h->px[s];
    int rows = rows_of(h, s);
    const int *row = h->row + h->pi[s];
    size_t k;
    if (!f->zero)
        memset(x, 0, (size_t)rows * (size_t)columns_of(h, s) * sizeof(real));
    for (k = h->begin[s]; k < h->begin[s + 1]; k++) {
        int place = h->target[k];
        double value = f->a[h->entry[k]];
        if (f->scale) {
            value *= f->scale[row[place % rows]] * f->scale[h->super[s] + place / rows];
        }
        x[place] = (real)value;
    }
}

/* List the descendants of supernode s, and pass them on to the next one that they give to, up to
 * `last`. */
static void gather(factor_type *f, own_type *w, int s, int last)
{
    const supernodal_plan *h = f->plan;
    int d, follow, k, rows = rows_of(h, s);
    const int *row = h->row + h->pi[s];
    for (k = 0; k < rows; k++) w->map[row[k]] = k;
    w->n = 0;
    for (d = f->head[s]; d >= 0; d = follow) {
        const int *below = h->row + h->pi[d];
        int end = f->at[d], up;
        follow = f->next[d];
        while (end < rows_of(h, d) && below[end] < h->super[s + 1]) end++;
        w->from[w->n] = d;
        w->begin[w->n] = f->at[d];
        w->end[w->n++] = end;
        f->at[d] = end;
        if (end == rows_of(h, d)) continue;
        up = h->owner[below[end]];
        if (up > last) continue;
        f->next[d] = f->head[up];
        f->head[up] = d;
    }
}

/* A supernode that is done gives to the one that its first row below belongs to. */
static void hand_on(factor_type *f, int s, int last)
{
    const supernodal_plan *h = f->plan;
    int up;
    f->at[s] = columns_of(h, s);
    if (f->at[s] == rows_of(h, s)) return;
    up = h->owner[h->row[h->pi[s] + f->at[s]]];
    if (up > last) return;
    f->next[s] = f->head[up];
    f->head[up] = s;
}

/* Products with columns of negative pivots count the other way: c <- c + 2 l l^T of each. */
static void turn_products(const factor_type *f, int d, int columns, int m, int n, const real *l,
                          const real *r, int rows, real *c, int ldc, int lower)
{
    int k, i, j;
    const signed char *sign = f->sign + f->plan->super[d];
    if (!f->negative[d]) return;
    for (k = 0; k < columns; k++) {
        const real *left = l + (size_t)k * (size_t)rows, *right = r + (size_t)k * (size_t)rows;
        if (sign[k] > 0) continue;
        for (j = 0; j < n; j++) {
            real twice = 2 * right[j], *to = c + (size_t)j * (size_t)ldc;
            for (i = lower ? j : 0; i < m; i++) to[i] += twice * left[i];
        }
    }
}

/* c <- beta c - l r^T (m, n), of which only the lower triangle counts where r is the top of l. */
static void take_product(const factor_type *f, int d, int columns, int m, int n, const real *l,
                         const real *r, int rows, real beta, real *c, int ldc)
{
    int lower = l == r, below = lower ? m - n : m;
    if (lower) syrk("L", "N", &n, &columns, &minus, l, &rows, &beta, c, &ldc);
    if (below > 0)
        gemm("N", "C", &below, &n, &columns, &minus, lower ? l + n : l, &rows, r, &rows, &beta,
             lower ? c + n : c, &ldc);
    if (f->signed_too) turn_products(f, d, columns, m, n, l, r, rows, c, ldc, lower);
}

/* First place from `low` on whose row is not below r. */
static int first_from(const int *row, int low, int high, int r)
{
    while (low < high) {
        int middle = low + (high - low) / 2;
        if (row[middle] < r) low = middle + 1;
        else high = middle;
    }
    return low;
}

/* What all descendants give to rows [r0, r1), columns [c0, c1) of supernode s. */
static void update_tile(factor_type *f, own_type *w, const own_type *lists, int s, int r0, int r1,
                        int c0, int c1)
{
    const supernodal_plan *h = f->plan;
    const int *own = h->row + h->pi[s];
    int ns = rows_of(h, s), first = h->super[s], k, i, j;
    real *target = f->x + h->px[s];
    for (k = 0; k < lists->n; k++) {
        int d = lists->from[k], rows = rows_of(h, d), columns = columns_of(h, d);
        const int *row = h->row + h->pi[d];
        int b0 = first_from(row, lists->begin[k], lists->end[k], first + c0), b1, m0, m1, m, n;
        const real *x = f->x + h->px[d];
        int lower, side_by_side;
        if (b0 == lists->end[k] || row[b0] >= first + c1) continue;
        b1 = first_from(row, b0, lists->end[k], first + c1);
        m0 = r0 <= c0 ? b0 : first_from(row, b0, rows, own[r0]);
        m1 = r1 == ns ? rows : first_from(row, m0, rows, own[r1]);
        m = m1 - m0;
        n = b1 - b0;
        if (m <= 0) continue;
        lower = m0 == b0;
        for (i = 0; i < m; i++) w->relative[i] = lists->map[row[m0 + i]];
        j = row[b0] - first;
        side_by_side = w->relative[m - 1] - w->relative[0] == m - 1
            && row[b1 - 1] - row[b0] == n - 1;
        if (side_by_side) {
            take_product(f, d, columns, m, n, x + m0, x + b0, rows, one,
                         target + (size_t)j * (size_t)ns + (size_t)w->relative[0], ns);
            continue;
        }
        take_product(f, d, columns, m, n, x + m0, x + b0, rows, zero, w->update, m);
        for (j = 0; j < n; j++) {
            const real *c = w->update + (size_t)j * (size_t)m;
            real *t = target + (size_t)(row[b0 + j] - first) * (size_t)ns;
            for (i = lower ? j : 0; i < m; i++) t[w->relative[i]] += c[i];
        }
    }
}

/* The factor of the block of columns [c0, c1) of supernode s on its diagonal. */
static int factorise_block(factor_type *f, own_type *w, int s, int c0, int c1)
{
    const supernodal_plan *h = f->plan;
    int rows = rows_of(h, s), n = c1 - c0, status;
    real *x = f->x + h->px[s] + (size_t)c0 * ((size_t)rows + 1);
    if (f->signed_too) keep_block(x, n, rows, w->kept);
    potrf("L", &n, x, &rows, &status);
    if (!status) return 1;
    if (f->signed_too) {
        put_back(x, n, rows, w->kept);
        if (factorise_signed(x, n, rows, f->sign + h->super[s] + c0)) return 1;
        status = 1;
    }
    status += h->super[s] + c0 - 1;
    if (w->failed < 0 || status < w->failed) w->failed = status;
    return 0;
}

/* Rows [r0, r1) of columns [c0, c1) of supernode s, below their block on the diagonal. */
static void divide(factor_type *f, int s, int r0, int r1, int c0, int c1)
{
    const supernodal_plan *h = f->plan;
    int rows = rows_of(h, s), m = r1 - r0, n = c1 - c0;
    real *column = f->x + h->px[s] + (size_t)c0 * (size_t)rows, *x = column + r0;
    if (m <= 0) return;
    trsm("R", "L", "C", "N", &m, &n, &one, column + c0, &rows, x, &rows);
    if (f->signed_too) turn_columns(x, n, m, rows, f->sign + h->super[s] + c0);
}

/* What columns [0, c0) of supernode s give to rows [r0, r1) of its columns [c0, c1). */
static void update_from_left(factor_type *f, int s, int r0, int r1, int c0, int c1)
{
    int rows = rows_of(f->plan, s);
    real *x = f->x + f->plan->px[s];
    if (c0 > 0 && r1 > r0)
        take_product(f, s, c0, r1 - r0, c1 - c0, x + r0, x + c0, rows, one,
                     x + (size_t)c0 * (size_t)rows + (size_t)r0, rows);
}

/* The first column without a pivot that any thread has found, or -1. */
static int first_failure(const factor_type *f, int threads)
{
    int failed = -1, k;
    for (k = 0; k < threads; k++)
        if (f->own[k].failed >= 0 && (failed < 0 || f->own[k].failed < failed))
            failed = f->own[k].failed;
    return failed;
}

static void count_negative(factor_type *f, int s, int c0, int c1)
{
    int k;
    for (k = f->plan->super[s] + c0; k < f->plan->super[s] + c1; k++)
        f->negative[s] += f->sign[k] < 0;
}

/* Rows that tile i has in the strip of columns from c0 on. */
static int begin_of(int i, int c0) { return most(i * TILE, c0); }

/* A supernode by one thread. */
static int factorise_alone(factor_type *f, own_type *w, int s, int last)
{
    const supernodal_plan *h = f->plan;
    int rows = rows_of(h, s), columns = columns_of(h, s), i, c0, c1;
    fill(f, s);
    gather(f, w, s, last);
    for (c0 = 0; c0 < columns; c0 = c1) {
        c1 = least(c0 + TILE, columns);
        for (i = c0 / TILE; i * TILE < rows; i++)
            update_tile(f, w, w, s, begin_of(i, c0), least((i + 1) * TILE, rows), c0, c1);
    }
    for (c0 = 0; c0 < columns; c0 = c1) {
        c1 = least(c0 + TILE, columns);
        for (i = c0 / TILE; i * TILE < rows; i++) {
            update_from_left(f, s, begin_of(i, c0), least((i + 1) * TILE, rows), c0, c1);
            if (i == c0 / TILE && !factorise_block(f, w, s, c0, c1)) return 0;
        }
        if (f->signed_too) count_negative(f, s, c0, c1);
        for (i = c0 / TILE; i * TILE < rows; i++)
            divide(f, s, begin_of(i, c1), least((i + 1) * TILE, rows), c0, c1);
    }
    hand_on(f, s, last);
    return 1;
}

/* A supernode of the top by all threads. */
static void factorise_together(factor_type *f, own_type *w, int s, team_type *team, int rank)
{
    const supernodal_plan *h = f->plan;
    int rows = rows_of(h, s), columns = columns_of(h, s), high = (rows + TILE - 1) / TILE;
    int before = 0, i, k, c0;
    if (rank == 0) {
        fill(f, s);
        gather(f, w, s, h->nsuper);
    }
    lopin_meet(team);
    k = lopin_take_next(team);
    for (c0 = 0; c0 < columns; c0 += TILE) {
        int at = c0 / TILE, next = before + high - at;
        for (; k < next; k = lopin_take_next(team)) {
            i = at + k - before;
            update_tile(f, w, f->own, s, begin_of(i, c0), least((i + 1) * TILE, rows), c0,
                        least(c0 + TILE, columns));
        }
        before = next;
    }
    lopin_meet(team);
    for (c0 = 0; c0 < columns; c0 += TILE) {
        int c1 = least(c0 + TILE, columns), at = c0 / TILE;
        for (i = at + lopin_take_next(team); i < high; i = at + lopin_take_next(team)) {
            update_from_left(f, s, begin_of(i, c0), least((i + 1) * TILE, rows), c0, c1);
            if (i == at) factorise_block(f, w, s, c0, c1);
        }
        lopin_meet(team);
        if (first_failure(f, lopin_team_size(team)) >= 0) return;
        if (rank == 0 && f->signed_too) count_negative(f, s, c0, c1);
        for (i = at + lopin_take_next(team); i < high; i = at + lopin_take_next(team))
            divide(f, s, begin_of(i, c1), least((i + 1) * TILE, rows), c0, c1);
        lopin_meet(team);
    }
    if (rank == 0) hand_on(f, s, h->nsuper);
}

/* Subtrees go on with the supernodes above them. */
static void link_subtrees(factor_type *f)
{
    const supernodal_plan *h = f->plan;
    int d, up;
    for (d = 0; d < h->nsuper; d++) {
        if (f->at[d] == rows_of(h, d)) continue;
        up = h->owner[h->row[h->pi[d] + f->at[d]]];
        f->next[d] = f->head[up];
        f->head[up] = d;
    }
}

static int no_memory(const factor_type *f, int threads)
{
    int k;
    for (k = 0; k < threads; k++)
        if (f->own[k].status) return 1;
    return 0;
}

static void factorise_by_team(team_type *team, int rank, void *argument)
{
    factor_type *f = argument;
    const supernodal_plan *h = f->plan;
    own_type *w = f->own + rank;
    int threads = lopin_team_size(team), k, s;
    w->status = make_own(w, h);
    lopin_meet(team);
    if (no_memory(f, threads)) return;
    for (k = lopin_take_next(team); k < h->nsubtree; k = lopin_take_next(team))
        for (s = h->first[k]; s <= h->last[k]; s++)
            if (!factorise_alone(f, w, s, h->last[k])) break;
    lopin_meet(team);
    if (first_failure(f, threads) >= 0) return;
    if (rank == 0) link_subtrees(f);
    for (k = 0; k < h->ntop; k++) {
        factorise_together(f, w, h->top[k], team, rank);
        if (first_failure(f, threads) >= 0) return;
    }
}

static int factorise_on(factor_type *f, int threads, int *failed)
{
    const supernodal_plan *h = f->plan;
    size_t n = (size_t)h->nsuper;
    int status = SUPERNODAL_OK, k;
    *failed = -1;
    f->next = malloc(4 * n * sizeof(int) + 1);
    f->own = calloc((size_t)threads, sizeof *f->own);
    if (f->next && f->own) {
        f->at = f->next + n;
        f->head = f->at + n;
        f->negative = f->head + n;
        memset(f->negative, 0, n * sizeof(int));
        for (k = 0; k < h->nsuper; k++) { f->head[k] = -1; f->at[k] = rows_of(h, k); }
        for (k = 0; k < threads; k++) f->own[k].failed = -1;   /* those that do not start, too */
        lopin_run_team(threads, factorise_by_team, f);
        *failed = first_failure(f, threads);
        if (*failed >= 0) status = SUPERNODAL_NOT_POSITIVE;
        if (no_memory(f, threads)) status = SUPERNODAL_NO_MEMORY;
        for (k = 0; k < threads; k++) free_own(f->own + k);
    } else {
        status = SUPERNODAL_NO_MEMORY;
    }
    free(f->next);
    free(f->own);
    return status;
}

/* As declared in supernodal.h. One thread needs less memory than several. */
static int factorise(factor_type *f, int threads, int *failed)
{
    int status;
    if (f->plan->flops < WORTH_A_THREAD) threads = 1;
    status = factorise_on(f, threads, failed);
    if (status != SUPERNODAL_NO_MEMORY || threads == 1) return status;
    f->zero = 0;
    if (f->sign) memset(f->sign, 1, (size_t)f->plan->n);
    return factorise_on(f, 1, failed);
}
