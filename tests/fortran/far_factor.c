/* A factor of which one half stands beyond 2**32 entries: memory that is promised, not used. */
#define _GNU_SOURCE
#include <stdlib.h>
#include <sys/mman.h>
#include "../../fortran/linalg/supernodal.h"

extern int lopin_cholmod_plan(void *handle, const int *p, const int *i,
                              const supernodal_plan **plan);

/* x <- A^-1 x by one thread or more; -1: the system does not promise so much. */
int far_factor_solve(void *handle, const int *p, const int *i, const double *a, int threads,
                     int columns, double *x)
{
    const size_t far_off = ((size_t)1 << 32) + 12345;
    const supernodal_plan *near;
    supernodal_plan far;
    size_t bytes;
    double *factor;
    int s, failed, status;
    if (lopin_cholmod_plan(handle, p, i, &near) || !near) return 1;
    far = *near;
    far.px = malloc(((size_t)near->nsuper + 1) * sizeof(size_t));
    if (!far.px) return 1;
    for (s = 0; s <= near->nsuper; s++)
        far.px[s] = near->px[s] + (s > near->nsuper / 2 ? far_off : 0);
    bytes = far.px[far.nsuper] * sizeof(double);
    factor = mmap(NULL, bytes, PROT_READ | PROT_WRITE,
                  MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (factor == MAP_FAILED) { free(far.px); return -1; }
    status = lopin_factorise_double(&far, a, factor, 1, threads, &failed);
    if (!status) status = lopin_supernodal_solve(&far, factor, CHOLMOD_A, columns, x, x);
    munmap(factor, bytes);
    free(far.px);
    return status;
}
