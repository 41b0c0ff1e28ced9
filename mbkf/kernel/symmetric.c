/* Tiles of eight by eight: a tile and its mirror image fit into the fastest cache, rows and columns do not. */
#include "symmetric.h"

#include "vectorised.h"

enum { TILE = 8 };

/* The columns of a tile of X become rows of another, on the other side of the diagonal. */
static inline void mirror_tile(int N, const double *from, double *to)
{
    for (int b = 0; b < TILE; b++)
        for (int a = 0; a < TILE; a++)
            to[(long)b * N + a] = from[(long)a * N + b];
}

VECTORISED void mirror(int N, double *X)
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

VECTORISED void transpose(int N, const double *X, double *out)
{
    const int full = N - N % TILE;
    for (int i = 0; i < full; i += TILE)
        for (int j = 0; j < full; j += TILE)
            mirror_tile(N, X + (long)i * N + j, out + (long)j * N + i);
    for (int i = 0; i < N; i++)
        for (int j = i < full ? full : 0; j < N; j++)
            out[(long)j * N + i] = X[(long)i * N + j];
}

VECTORISED void symmetrise(int N, double *X)
{
    for (int first = 0; first < N; first += TILE)
        for (int second = first; second < N; second += TILE)
            for (int i = first; i < first + TILE && i < N; i++)
                for (int j = second > i ? second : i; j < second + TILE && j < N; j++)
                    X[(long)i * N + j] = X[(long)j * N + i] = X[(long)i * N + j] + X[(long)j * N + i];
}
