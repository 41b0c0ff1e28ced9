/* Functions compiled for several instruction sets, the best of which is chosen at run time, if the compiler can. */
#ifndef MBKF_VECTORISED_H
#define MBKF_VECTORISED_H

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__gnu_linux__)
#define VECTORISED __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define VECTORISED
#endif

/* Functions with 512-bit vectors, for processors where product_is_own. */
#if defined(__GNUC__) && defined(__x86_64__)
#define HAS_WIDE 1
#define WIDE __attribute__((target("avx512f,fma")))
#else
#define HAS_WIDE 0
#endif

#endif
