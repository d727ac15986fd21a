/* Procedures that are compiled once more for processors with longer vectors (nothing is fused: the
 * same bits), and places in memory that are asked for ahead. */
#ifndef LOPIN_EVERY_PROCESSOR_H
#define LOPIN_EVERY_PROCESSOR_H
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__gnu_linux__)
#define FOR_EACH_PROCESSOR __attribute__((target_clones("avx2", "default")))
#define FETCH(place) __builtin_prefetch(place)
#else
#define FOR_EACH_PROCESSOR
#define FETCH(place) (void)0
#endif
#endif
