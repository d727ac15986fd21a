/* Memory that is freed stays with the process, up to a bound: each Newton iteration asks for the same arrays again, and
 * the system would clear every page of them anew. By itself the C library gives back whatever lies free at the end
 * beyond twice the largest array it has mapped. Arrays of 32 MiB and more are mapped one by one, and go back. */
#include <stdlib.h>

#if defined(__GLIBC__)
#include <malloc.h>

__attribute__((constructor)) static void keep_memory(void)
{
    mallopt(M_MMAP_THRESHOLD, 32 << 20);
    mallopt(M_TRIM_THRESHOLD, 64 << 20);
}
#endif
