/* Products of the size of a body's state: with 512-bit vectors in tiles that stay in registers, else by BLAS. At 50 to
 * 200 rows BLAS spends as much time on packing its operands as on their product. */
#include "product.h"

#include <string.h>

#include "blas.h"
#include "declared.h"
#include "vectorised.h"

static void by_blas(int part, int rows, int columns, int inner, double factor, const double *A, int lda,
                    const double *B, int ldb, double keep, const double *D, double *C, int ldc)
{
    if (!rows || !columns) /* BLAS would print that a stride is 0 */
        return;
    if (keep != 0.0 && D != C)
        for (int j = 0; j < columns; j++)
            memcpy(C + (long)j * ldc, D + (long)j * ldc, sizeof(double) * rows);
    if (part == LOWER && A == B && lda == ldb)
        blas.dsyrk("l", "n", &rows, &inner, &factor, (double *)A, &lda, &keep, C, &ldc);
    else
        blas.dgemm("n", "t", &rows, &columns, &inner, &factor, (double *)A, &lda, (double *)B, &ldb, &keep, C,
                   &ldc);
}

#if HAS_WIDE
#include <immintrin.h>

enum { LANES = 8, VECTORS = 3, HEIGHT = LANES * VECTORS, BREADTH = 8 };

/* A tile of up to height vectors x breadth. Both are constants where this is inlined: else compilers would not unroll the
 * loops and keep all sums in registers. */
WIDE static inline __attribute__((always_inline)) void tile(int height, int breadth, const __mmask8 *mask, int inner,
                                                            double factor, const double *A, int lda,
                                                            const double *B, int ldb, double keep, const double *D,
                                                            double *C, int ldc)
{
    __m512d sum[BREADTH][VECTORS];
    for (int j = 0; j < breadth; j++)
        for (int v = 0; v < height; v++)
            sum[j][v] = _mm512_setzero_pd();
    for (int p = 0; p < inner; p++) {
        __m512d a[VECTORS];
        for (int v = 0; v < height; v++)
            a[v] = _mm512_maskz_loadu_pd(mask[v], A + (long)p * lda + v * LANES);
        for (int j = 0; j < breadth; j++) {
            const __m512d b = _mm512_set1_pd(B[(long)p * ldb + j]);
            for (int v = 0; v < height; v++)
                sum[j][v] = _mm512_fmadd_pd(a[v], b, sum[j][v]);
        }
    }
    for (int j = 0; j < breadth; j++)
        for (int v = 0; v < height; v++) {
            double *c = C + (long)j * ldc + v * LANES;
            __m512d found = _mm512_mul_pd(_mm512_set1_pd(factor), sum[j][v]);
            if (keep != 0.0)
                found = _mm512_fmadd_pd(_mm512_set1_pd(keep), _mm512_maskz_loadu_pd(mask[v], D + (long)j * ldc + v * LANES), found);
            _mm512_mask_storeu_pd(c, mask[v], found);
        }
}

WIDE static void by_tiles(int part, int rows, int columns, int inner, double factor, const double *A, int lda,
                          const double *B, int ldb, double keep, const double *D, double *C, int ldc)
{
    for (int j = 0; j < columns; j += BREADTH) {
        const int breadth = j + BREADTH < columns ? BREADTH : columns - j;
        for (int i = part == LOWER ? j : 0; i < rows; i += HEIGHT) {
            __mmask8 mask[VECTORS];
            for (int v = 0; v < VECTORS; v++) {
                const int left = rows - i - v * LANES;
                mask[v] = left >= LANES ? 0xff : left > 0 ? (__mmask8)((1 << left) - 1) : 0;
            }
            const double *a = A + i, *b = B + j;
            const double *d = keep != 0.0 ? D + (long)j * ldc + i : NULL;
            double *c = C + (long)j * ldc + i;
            switch (BREADTH * (mask[2] ? 2 : mask[1] ? 1 : 0) + breadth) {
#define OF_BREADTH(height, n)                                                \
    case BREADTH * (height - 1) + n:                                         \
        tile(height, n, mask, inner, factor, a, lda, b, ldb, keep, d, c, ldc); \
        break;
#define OF_HEIGHT(height)                                                                                 \
    OF_BREADTH(height, 1) OF_BREADTH(height, 2) OF_BREADTH(height, 3) OF_BREADTH(height, 4)               \
    OF_BREADTH(height, 5) OF_BREADTH(height, 6) OF_BREADTH(height, 7) OF_BREADTH(height, 8)
                OF_HEIGHT(1)
                OF_HEIGHT(2)
                OF_HEIGHT(3)
#undef OF_HEIGHT
#undef OF_BREADTH
            }
        }
    }
}

static int possible(void) { return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("fma"); }

#else
#define by_tiles by_blas

static int possible(void) { return 0; }
#endif

static int own = -1; /* unknown yet */

int product_is_own(void)
{
    if (own < 0)
        own = possible();
    return own;
}

void mbkf_choose_products(int wanted) { own = wanted && possible(); }

int mbkf_vector_bits(void) { return product_is_own() ? 512 : 0; }

void product(int part, int rows, int columns, int inner, double factor, const double *A, int lda, const double *B,
             int ldb, double keep, const double *D, double *C, int ldc)
{
    if (product_is_own())
        by_tiles(part, rows, columns, inner, factor, A, lda, B, ldb, keep, D, C, ldc);
    else
        by_blas(part, rows, columns, inner, factor, A, lda, B, ldb, keep, D, C, ldc);
}
