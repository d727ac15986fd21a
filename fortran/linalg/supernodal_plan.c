/* The plan of a supernodal factorisation: which supernodes form subtrees, where entries go. */
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include "supernodal.h"

/* A subtree takes at most this part of the work: small enough to share out among a few threads,
 * large enough that trees without a dense top are mostly subtrees. */
static const double part_of_subtree = 1.0 / 24.0;

void lopin_supernodal_free(supernodal_plan **out)
{
    supernodal_plan *h = *out;
    if (!h) return;
    free(h->owner); free(h->first); free(h->last); free(h->top); free(h->begin); free(h->entry);
    free(h->target); free(h->px); free(h);
    *out = NULL;
}

static double work_of(const supernodal_plan *h, int s)
{
    int rows = h->pi[s + 1] - h->pi[s], columns = h->super[s + 1] - h->super[s], k;
    double sum = 0.0;
    for (k = 0; k < columns; k++) sum += (double)(rows - k) * (double)(rows - k);
    return sum;
}

typedef struct { double work; int first, last; } subtree_type;

static int most_work_first(const void *a, const void *b)
{
    const subtree_type *s = a, *t = b;
    if (s->work != t->work) return s->work < t->work ? 1 : -1;
    return s->first < t->first ? -1 : 1;
}

/* The largest subtrees, of supernodes in a row, that take no more than their part. */
static int cut_tree(supernodal_plan *h)
{
    int n = h->nsuper, s, k, *parent = malloc(3 * (size_t)n * sizeof(int) + 1);
    int *first = parent + n, *count = first + n;
    double *work = calloc((size_t)n + 1, sizeof(double)), limit;
    subtree_type *tree = malloc((size_t)n * sizeof *tree + 1);
    if (!parent || !work || !tree) {
        free(parent); free(work); free(tree);
        return SUPERNODAL_NO_MEMORY;
    }
    for (s = 0; s < n; s++) { first[s] = s; count[s] = 1; }
    for (s = 0; s < n; s++) {
        int columns = h->super[s + 1] - h->super[s], rows = h->pi[s + 1] - h->pi[s], up;
        double own = work_of(h, s);
        h->flops += own;
        work[s] += own;
        parent[s] = up = rows > columns ? h->owner[h->row[h->pi[s] + columns]] : -1;
        if (up < 0) continue;
        work[up] += work[s];
        count[up] += count[s];
        if (first[s] < first[up]) first[up] = first[s];
    }
    limit = part_of_subtree * h->flops;
    h->nsubtree = h->ntop = 0;
    for (s = n - 1; s >= 0; s--) {
        if (work[s] > limit || s - first[s] + 1 != count[s]) { h->top[h->ntop++] = s; continue; }
        tree[h->nsubtree].work = work[s];
        tree[h->nsubtree].first = first[s];
        tree[h->nsubtree++].last = s;
        s = first[s];                         /* and on with what is before it */
    }
    for (k = 0; k < h->ntop / 2; k++) {
        s = h->top[k];
        h->top[k] = h->top[h->ntop - 1 - k];
        h->top[h->ntop - 1 - k] = s;
    }
    qsort(tree, (size_t)h->nsubtree, sizeof *tree, most_work_first);
    for (k = 0; k < h->nsubtree; k++) { h->first[k] = tree[k].first; h->last[k] = tree[k].last; }
    free(parent); free(work); free(tree);
    return SUPERNODAL_OK;
}

static int position_in(const int *row, int n, int r)
{
    int low = 0;
    while (n > 1) {
        int half = n / 2;
        if (row[low + half] <= r) { low += half; n -= half; }
        else n = half;
    }
    return low;
}

/* The supernode that an entry of column j, row r of the matrix belongs to, its row and column. */
static int owner_of(const supernodal_plan *h, const int *inverse, int j, int r, int *low)
{
    int a = inverse[r], b = inverse[j], c = a < b ? a : b;
    *low = a < b ? b : a;
    return h->owner[c];
}

static int place_entries(supernodal_plan *h, const int *p, const int *i)
{
    int *inverse = malloc((size_t)h->n * sizeof(int) + 1), j, k, s, low;
    size_t *next = malloc(((size_t)h->nsuper + 1) * sizeof(size_t));
    if (!inverse || !next) { free(inverse); free(next); return SUPERNODAL_NO_MEMORY; }
    for (k = 0; k < h->n; k++) inverse[h->perm[k]] = k;
    for (j = 0; j < h->n; j++)
        for (k = p[j]; k < p[j + 1]; k++) h->begin[owner_of(h, inverse, j, i[k], &low) + 1]++;
    for (s = 0; s < h->nsuper; s++) h->begin[s + 1] += h->begin[s];
    memcpy(next, h->begin, ((size_t)h->nsuper + 1) * sizeof(size_t));
    for (j = 0; j < h->n; j++)
        for (k = p[j]; k < p[j + 1]; k++) {
            int rows, column;
            s = owner_of(h, inverse, j, i[k], &low);
            rows = h->pi[s + 1] - h->pi[s];
            column = (inverse[i[k]] < inverse[j] ? inverse[i[k]] : inverse[j]) - h->super[s];
            h->entry[next[s]] = k;
            h->target[next[s]++] = column * rows + position_in(h->row + h->pi[s], rows, low);
        }
    free(inverse); free(next);
    return SUPERNODAL_OK;
}

static size_t entries_of(const int *super, const int *pi, int s)
{
    return (size_t)(super[s + 1] - super[s]) * (size_t)(pi[s + 1] - pi[s]);
}

size_t lopin_supernodal_entries(const cholmod_factor *L)
{
    size_t sum = 0;
    for (int s = 0; s < (int)L->nsuper; s++) sum += entries_of(L->super, L->pi, s);
    return sum;
}

int lopin_supernodal_plan(supernodal_plan **out, const cholmod_factor *L, const int *p,
                          const int *i)
{
    supernodal_plan *h = calloc(1, sizeof *h);
    int s, k;
    *out = h;
    if (!h) return SUPERNODAL_NO_MEMORY;
    h->n = (int)L->n;
    h->nsuper = (int)L->nsuper;
    h->super = L->super; h->pi = L->pi; h->row = L->s; h->perm = L->Perm;
    h->owner = malloc((size_t)h->n * sizeof(int) + 1);
    h->px = malloc(((size_t)h->nsuper + 1) * sizeof(size_t));
    h->first = malloc((size_t)h->nsuper * sizeof(int) + 1);
    h->last = malloc((size_t)h->nsuper * sizeof(int) + 1);
    h->top = malloc((size_t)h->nsuper * sizeof(int) + 1);
    h->begin = calloc((size_t)h->nsuper + 1, sizeof(size_t));
    h->entry = malloc((size_t)p[h->n] * sizeof(int) + 1);
    h->target = malloc((size_t)p[h->n] * sizeof(int) + 1);
    if (!h->owner || !h->px || !h->first || !h->last || !h->top || !h->begin || !h->entry
        || !h->target)
        return SUPERNODAL_NO_MEMORY;
    h->px[0] = 0;
    for (s = 0; s < h->nsuper; s++) {
        size_t entries = entries_of(h->super, h->pi, s);
        int rows = h->pi[s + 1] - h->pi[s];
        if (entries > INT_MAX) return SUPERNODAL_TOO_LARGE;
        h->px[s + 1] = h->px[s] + entries;
        if (rows > h->most_rows) h->most_rows = rows;
        for (k = h->super[s]; k < h->super[s + 1]; k++) h->owner[k] = s;
    }
    k = cut_tree(h);
    return k ? k : place_entries(h, p, i);
}
