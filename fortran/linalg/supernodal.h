/* The plan of a supernodal factorisation, made once from the symbolic analysis of CHOLMOD, and the
 * factorisations that follow it (supernodal_double.c, supernodal_single.c).
 *
 * The tree of supernodes is cut into subtrees, each of which one thread factorises by itself, and
 * what is above them, where all threads share the tiles of one supernode. The cut and the tiles
 * depend on the analysis alone, never on the number of threads: whatever that is, the factor has
 * the same bits. Threads take what is to be done next from one counter, so that one that another
 * program holds up takes less. Functions return 0 or a code of `enum supernodal_status`. */
#ifndef LOPIN_SUPERNODAL_H
#define LOPIN_SUPERNODAL_H
#include <stddef.h>
#include <cholmod.h>
#include "../base/team.h"

enum supernodal_status { SUPERNODAL_OK = 0, SUPERNODAL_NO_MEMORY = 1, SUPERNODAL_NOT_POSITIVE = 2,
                         SUPERNODAL_TOO_LARGE = 3 };

typedef struct {
    int n, nsuper;
    const int *super, *pi, *row, *perm;       /* of the analysis, which outlives this */
    size_t *px;                               /* (nsuper + 1) where they begin in the factor */
    int *owner;                               /* (n) supernode of a column */
    int nsubtree, *first, *last;              /* ranges of supernodes, most work first */
    int ntop, *top;                           /* supernodes above them, ascending */
    int most_rows;                            /* of a supernode */
    double flops;                             /* additions and multiplications of a factorisation */
    size_t *begin;                            /* (nsuper + 1) entries of the matrix by supernode */
    int *entry;                               /* their positions in the matrix */
    int *target;                              /* and in their supernode */
} supernodal_plan;

/* Entries of a factor, those of supernodes that stay zero too. */
size_t lopin_supernodal_entries(const cholmod_factor *L);

/* Lower triangle by columns, 0-based, sorted rows; `L` is analysed for this pattern. A factor may
 * have any number of entries, one of its supernodes fewer than 2**31. */
int lopin_supernodal_plan(supernodal_plan **out, const cholmod_factor *L, const int *p,
                          const int *i);
void lopin_supernodal_free(supernodal_plan **out);

/* L L^T of the matrix with these values, by up to `threads` threads. `zero`: x holds zeros.
 * *failed: column without a positive pivot. */
int lopin_factorise_double(const supernodal_plan *plan, const double *a, double *x, int zero,
                           int threads, int *failed);

/* out <- what `system` says: CHOLMOD_A, of the equations; CHOLMOD_L or CHOLMOD_Lt, of the lower
 * factor or its transpose, both sides in the order of the factor. b and out: (n, columns), they may
 * be one. */
int lopin_supernodal_solve(const supernodal_plan *plan, const double *x, int system, int columns,
                           const double *b, double *out);

/* Of D A D, where scale (n) holds D in the order of the factor; `sign` (n): of the pivots. Negative
 * ones are taken where `signed_too`. */
int lopin_factorise_single(const supernodal_plan *plan, const double *a, const double *scale,
                           float *x, int signed_too, signed char *sign, int threads, int *failed);
#endif
