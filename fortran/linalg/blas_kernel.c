/* The kernel of the BLAS, where it does not know the processor.
 *
 * An OpenBLAS that is older than the processor falls back to the kernel of 2004 (Prescott), whose
 * products take three to five times as long as those of a kernel that the processor has the
 * instructions for. Its environment variable OPENBLAS_CORETYPE says another one; that is read once
 * more here. */
#include <stdlib.h>
#include <string.h>

/* Present in OpenBLAS that has several kernels. */
extern char *openblas_get_corename(void) __attribute__((weak));
extern void gotoblas_dynamic_init(void) __attribute__((weak));
extern void gotoblas_dynamic_quit(void) __attribute__((weak));

static int chosen = 0;

#if defined(__GNUC__) && defined(__x86_64__)
/* A kernel whose instructions the processor and the system have; NULL: none. Those of 512 bits are
 * faster by 1.4, but the whole suite has not been run with them (docs/solvers.md). */
static const char *kernel_of_processor(void)
{
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return "Haswell";
    return NULL;
}
#else
static const char *kernel_of_processor(void) { return NULL; }
#endif

/* Take a better kernel than the one that the BLAS falls back to, unless the user has said one. */
void lopin_choose_blas_kernel(void)
{
    static int done = 0;
    const char *name;
    if (done) return;
    done = 1;
    if (!openblas_get_corename || !gotoblas_dynamic_init || !gotoblas_dynamic_quit) return;
    if (getenv("OPENBLAS_CORETYPE") || strcmp(openblas_get_corename(), "Prescott")) return;
    name = kernel_of_processor();
    if (!name || setenv("OPENBLAS_CORETYPE", name, 1)) return;
    gotoblas_dynamic_quit();
    gotoblas_dynamic_init();
    unsetenv("OPENBLAS_CORETYPE");
    chosen = strcmp(openblas_get_corename(), "Prescott") != 0;
}

/* Its name, '' where the BLAS does not say; the result: whether it was chosen here. */
int lopin_blas_kernel(char *name, int room)
{
    name[0] = '\0';
    if (openblas_get_corename) {
        strncpy(name, openblas_get_corename(), (size_t)room - 1);
        name[room - 1] = '\0';
    }
    return chosen;
}
