/* Tiles of eight by eight: a tile and its mirror image fit into the fastest cache, rows and columns do not. */
#include "symmetric.h"

#include "product.h"
#include "vectorised.h"

enum { TILE = 8 };

#if defined(__GNUC__) && defined(__x86_64__)
#include <immintrin.h>

#define WIDE __attribute__((target("avx512f")))

static inline int fewer(int a, int b) { return a < b ? a : b; }

/* A tile's columns (up to 8 of up to 8 numbers) become rows elsewhere; with below, only their part left of the diagonal. */
WIDE static inline void turn_tile(int rows, int columns, const double *from, long lda, double *to, long ldb, int below)
{
    enum { EVEN = 0x88, ODD = 0xdd }; /* quarters of two vectors */
    const __mmask8 wide = (__mmask8)((1u << columns) - 1), high = (__mmask8)((1u << rows) - 1);
    __m512d row[TILE], pair[TILE], found[TILE];
    for (int i = 0; i < TILE; i++)
        row[i] = i < rows ? _mm512_maskz_loadu_pd(wide, from + i * lda) : _mm512_setzero_pd();
    for (int i = 0; i < TILE; i += 2) {
        pair[i] = _mm512_unpacklo_pd(row[i], row[i + 1]);
        pair[i + 1] = _mm512_unpackhi_pd(row[i], row[i + 1]);
    }
    for (int i = 0; i < 2; i++) {
        const __m512d a = _mm512_shuffle_f64x2(pair[i], pair[i + 2], EVEN);
        const __m512d b = _mm512_shuffle_f64x2(pair[i], pair[i + 2], ODD);
        const __m512d c = _mm512_shuffle_f64x2(pair[i + 4], pair[i + 6], EVEN);
        const __m512d d = _mm512_shuffle_f64x2(pair[i + 4], pair[i + 6], ODD);
        found[i] = _mm512_shuffle_f64x2(a, c, EVEN);
        found[i + 2] = _mm512_shuffle_f64x2(b, d, EVEN);
        found[i + 4] = _mm512_shuffle_f64x2(a, c, ODD);
        found[i + 6] = _mm512_shuffle_f64x2(b, d, ODD);
    }
    for (int j = 0; j < columns; j++)
        _mm512_mask_storeu_pd(to + j * ldb, below ? high & (__mmask8)((1u << j) - 1) : high, found[j]);
}

WIDE static int turned_wide(int rows, int columns, const double *A, long lda, double *B, long ldb)
{
    for (int i = 0; i < rows; i += TILE)
        for (int j = 0; j < columns; j += TILE)
            turn_tile(fewer(TILE, rows - i), fewer(TILE, columns - j), A + i * lda + j, lda, B + j * ldb + i, ldb, 0);
    return 1;
}

WIDE static int mirrored_wide(int N, double *X)
{
    for (long i = 0; i < N; i += TILE)
        for (long j = i; j < N; j += TILE)
            turn_tile(fewer(TILE, N - i), fewer(TILE, N - j), X + i * N + j, N, X + j * N + i, N, i == j);
    return 1;
}
#else
static int turned_wide(int rows, int columns, const double *A, long lda, double *B, long ldb)
{
    (void)rows, (void)columns, (void)A, (void)lda, (void)B, (void)ldb;
    return 0;
}

static int mirrored_wide(int N, double *X)
{
    (void)N, (void)X;
    return 0;
}
#endif

/* The columns of a tile of X become rows of another, on the other side of the diagonal. */
static inline void mirror_tile(int N, const double *from, double *to)
{
    for (int b = 0; b < TILE; b++)
        for (int a = 0; a < TILE; a++)
            to[(long)b * N + a] = from[(long)a * N + b];
}

VECTORISED static void mirror_narrow(int N, double *X)
{
    const int full = N - N % TILE;
    for (int i = 0; i < full; i += TILE) {
        for (int b = 1; b < TILE; b++)
            for (int a = 0; a < b; a++)
                X[(long)(i + b) * N + i + a] = X[(long)(i + a) * N + i + b];
        for (int j = i + TILE; j < full; j += TILE)
            mirror_tile(N, X + (long)i * N + j, X + (long)j * N + i);
    }
    for (int j = full; j < N; j++)
        for (int i = 0; i < j; i++)
            X[(long)j * N + i] = X[(long)i * N + j];
}

void mirror(int N, double *X)
{
    if (!product_is_own() || !mirrored_wide(N, X))
        mirror_narrow(N, X);
}

VECTORISED static void transpose_narrow(int N, const double *X, double *out)
{
    const int full = N - N % TILE;
    for (int i = 0; i < full; i += TILE)
        for (int j = 0; j < full; j += TILE)
            mirror_tile(N, X + (long)i * N + j, out + (long)j * N + i);
    for (int i = 0; i < N; i++)
        for (int j = i < full ? full : 0; j < N; j++)
            out[(long)j * N + i] = X[(long)i * N + j];
}

void transpose(int N, const double *X, double *out)
{
    if (!product_is_own() || !turned_wide(N, N, X, N, out, N))
        transpose_narrow(N, X, out);
}

void transposed(int rows, int columns, const double *A, int lda, double *B)
{
    if (product_is_own() && turned_wide(columns, rows, A, lda, B, columns))
        return;
    for (int j = 0; j < columns; j++)
        for (int i = 0; i < rows; i++)
            B[(long)i * columns + j] = A[(long)j * lda + i];
}

VECTORISED void symmetrise(int N, double *X)
{
    for (int first = 0; first < N; first += TILE)
        for (int second = first; second < N; second += TILE)
            for (int i = first; i < first + TILE && i < N; i++)
                for (int j = second > i ? second : i; j < second + TILE && j < N; j++)
                    X[(long)i * N + j] = X[(long)j * N + i] = X[(long)i * N + j] + X[(long)j * N + i];
}
