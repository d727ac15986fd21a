/* Memory that ends inside the compiled part of the package.
 *
 * Compiled code ends the process where an allocation is refused, in the middle of work that cannot be
 * taken back. Its allocations go through here (--wrap of the linker), so that it ends with the words
 * and the exit code of the executable, and the summary of a run that had begun says so. */
#include <stddef.h>
#include <stdio.h>
#include <unistd.h>

extern void lopin_summary_failed(void);
void *__real_malloc(size_t n);
void *__real_calloc(size_t count, size_t n);
void *__real_realloc(void *old, size_t n);

static void end(size_t n)
{
    char text[300];
    int length = snprintf(text, sizeof text,
                          "error[E0702]: not enough memory: the system refuses %.3g MB more\n"
                          "  = help: a coarser mesh or more memory; the files of a run are whole, and "
                          "resume=True goes on\n", (double)n/1048576.0);
    if (length > 0 && write(2, text, (size_t)length) >= 0) lopin_summary_failed();
    _exit(5);
}

void *__wrap_malloc(size_t n)
{
    void *place = __real_malloc(n);
    if (!place && n > 0) end(n);
    return place;
}

void *__wrap_calloc(size_t count, size_t n)
{
    void *place = __real_calloc(count, n);
    if (!place && count > 0 && n > 0) end(count*n);
    return place;
}

void *__wrap_realloc(void *old, size_t n)
{
    void *place = __real_realloc(old, n);
    if (!place && n > 0) end(n);
    return place;
}
