/* What the processor can do, asked at run time: how many numbers of double precision its vectors
 * hold. Eight only where they do not make it slower (the processors that have AVX-512 VBMI). */

int lopin_vector_width(void)
{
#if defined(__x86_64__) && defined(__GNUC__)
    if (__builtin_cpu_supports("avx512vbmi") && __builtin_cpu_supports("avx512vl")
        && __builtin_cpu_supports("avx512dq"))
        return 8;
    if (__builtin_cpu_supports("avx2")) return 4;
#endif
    return 2;
}
