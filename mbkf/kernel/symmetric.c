/* Tiles of eight by eight: a tile and its mirror image fit into the fastest cache, rows and columns do not. With 512-bit
 * vectors a tile is turned in registers. */
#include "symmetric.h"

#include "product.h"
#include "vectorised.h"

enum { TILE = 8 };

#if HAS_WIDE
#include <immintrin.h>

typedef struct {
    __m512d row[TILE];
} Tile;

/* The first so many lanes. */
static inline __mmask8 first_lanes(int count) { return count < TILE ? (__mmask8)((1 << count) - 1) : 0xff; }

/* A tile of which so many rows and columns lie in the matrix; the others are zero. */
WIDE static inline Tile loaded(int rows, int columns, const double *from, int stride)
{
    Tile tile;
    for (int i = 0; i < TILE; i++)
        tile.row[i] = i < rows ? _mm512_maskz_loadu_pd(first_lanes(columns), from + (long)i * stride) : _mm512_setzero_pd();
    return tile;
}

WIDE static inline void store(int rows, int columns, Tile tile, double *to, int stride)
{
    for (int i = 0; i < TILE && i < rows; i++)
        _mm512_mask_storeu_pd(to + (long)i * stride, first_lanes(columns), tile.row[i]);
}

/* Rows become columns: pairs of rows first, then pairs of pairs, then both halves. */
WIDE static inline Tile turned(Tile t)
{
    Tile out;
    for (int odd = 0; odd < 2; odd++) {
        __m512d pair[4];
        for (int k = 0; k < 4; k++)
            pair[k] = odd ? _mm512_unpackhi_pd(t.row[2 * k], t.row[2 * k + 1]) : _mm512_unpacklo_pd(t.row[2 * k], t.row[2 * k + 1]);
        const __m512d a = _mm512_shuffle_f64x2(pair[0], pair[1], 0x88), b = _mm512_shuffle_f64x2(pair[2], pair[3], 0x88);
        const __m512d c = _mm512_shuffle_f64x2(pair[0], pair[1], 0xdd), d = _mm512_shuffle_f64x2(pair[2], pair[3], 0xdd);
        out.row[odd] = _mm512_shuffle_f64x2(a, b, 0x88);
        out.row[odd + 2] = _mm512_shuffle_f64x2(c, d, 0x88);
        out.row[odd + 4] = _mm512_shuffle_f64x2(a, b, 0xdd);
        out.row[odd + 6] = _mm512_shuffle_f64x2(c, d, 0xdd);
    }
    return out;
}

WIDE static void wide_mirror(int N, double *X)
{
    for (int i = 0; i < N; i += TILE) {
        double *own = X + (long)i * N + i;
        Tile upper = loaded(N - i, N - i, own, N), lower = turned(upper);
        for (int k = 0; k < TILE; k++)
            upper.row[k] = _mm512_mask_blend_pd((__mmask8)(0xff << k), lower.row[k], upper.row[k]);
        store(N - i, N - i, upper, own, N);
        for (int j = i + TILE; j < N; j += TILE)
            store(N - j, TILE, turned(loaded(TILE, N - j, X + (long)i * N + j, N)), X + (long)j * N + i, N);
    }
}

WIDE static void wide_transposed(int rows, int columns, const double *A, int lda, double *B)
{
    for (int j = 0; j < columns; j += TILE)
        for (int i = 0; i < rows; i += TILE)
            store(rows - i, columns - j, turned(loaded(columns - j, rows - i, A + (long)j * lda + i, lda)),
                  B + (long)i * columns + j, columns);
}

WIDE static void wide_symmetrise(int N, double *X)
{
    for (int i = 0; i < N; i += TILE)
        for (int j = i; j < N; j += TILE) {
            double *here = X + (long)i * N + j, *there = X + (long)j * N + i;
            Tile sum = loaded(N - i, N - j, here, N);
            const Tile other = turned(loaded(N - j, N - i, there, N));
            for (int k = 0; k < TILE; k++)
                sum.row[k] = _mm512_add_pd(sum.row[k], other.row[k]);
            store(N - i, N - j, sum, here, N);
            if (j > i)
                store(N - j, N - i, turned(sum), there, N);
        }
}
#else
#define wide_mirror mirror_by_tiles
#define wide_transposed transposed_by_tiles
#define wide_symmetrise symmetrise_by_tiles
#endif

static int end_of(int first, int N) { return first + TILE < N ? first + TILE : N; }

VECTORISED static void transposed_by_tiles(int rows, int columns, const double *A, int lda, double *B)
{
    for (int first = 0; first < columns; first += TILE)
        for (int second = 0; second < rows; second += TILE)
            for (int j = first; j < end_of(first, columns); j++)
                for (int i = second; i < end_of(second, rows); i++)
                    B[(long)i * columns + j] = A[(long)j * lda + i];
}

VECTORISED static void mirror_by_tiles(int N, double *X)
{
    for (int first = 0; first < N; first += TILE)
        for (int second = first; second < N; second += TILE)
            for (int i = first; i < end_of(first, N); i++)
                for (int j = second > i ? second : i; j < end_of(second, N); j++)
                    X[(long)j * N + i] = X[(long)i * N + j];
}

VECTORISED static void symmetrise_by_tiles(int N, double *X)
{
    for (int first = 0; first < N; first += TILE)
        for (int second = first; second < N; second += TILE)
            for (int i = first; i < end_of(first, N); i++)
                for (int j = second > i ? second : i; j < end_of(second, N); j++)
                    X[(long)i * N + j] = X[(long)j * N + i] = X[(long)i * N + j] + X[(long)j * N + i];
}

void mirror(int N, double *X) { product_is_own() ? wide_mirror(N, X) : mirror_by_tiles(N, X); }

void transposed(int rows, int columns, const double *A, int lda, double *B)
{
    product_is_own() ? wide_transposed(rows, columns, A, lda, B) : transposed_by_tiles(rows, columns, A, lda, B);
}

void symmetrise(int N, double *X) { product_is_own() ? wide_symmetrise(N, X) : symmetrise_by_tiles(N, X); }
