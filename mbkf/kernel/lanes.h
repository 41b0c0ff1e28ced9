/* Eight numbers that are worked on together: a vector where the compiler knows vectors, else an array. */
#ifndef MBKF_LANES_H
#define MBKF_LANES_H

enum { LANES = 8 };

#if defined(__GNUC__)

typedef double Lanes __attribute__((vector_size(8 * LANES), aligned(8), may_alias));
/* Inlined, so that sums stay in registers of the caller's instruction set. */
#define ON_LANES static inline __attribute__((always_inline))
#else

typedef struct {
    double at[LANES];
} Lanes;
#define ON_LANES static inline

#endif

/* sum += factor x */
ON_LANES void add_multiple(Lanes *sum, double factor, const Lanes *x)
{
#if defined(__GNUC__)
    *sum += factor * *x;
#else
    for (int i = 0; i < LANES; i++)
        sum->at[i] += factor * x->at[i];
#endif
}

/* sum += factor x y, number by number */
ON_LANES void add_product(Lanes *sum, double factor, const Lanes *x, const Lanes *y)
{
#if defined(__GNUC__)
    *sum += factor * *x * *y;
#else
    for (int i = 0; i < LANES; i++)
        sum->at[i] += factor * x->at[i] * y->at[i];
#endif
}

#endif
