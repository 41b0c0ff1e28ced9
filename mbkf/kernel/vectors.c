/* Sums and products of vectors, and a matrix times a vector. */
#include "vectors.h"

#include "vectorised.h"

VECTORISED void plus(int N, double a, const double *x, double *y)
{
    for (int i = 0; i < N; i++)
        y[i] += a * x[i];
}

VECTORISED void add_columns(int rows, int columns, double factor, const double *X, const double *x,
                            double *restrict y)
{
    int k = 0;
    for (; k + 4 <= columns; k += 4) {
        const double *c = X + (long)k * rows;
        const double a = factor * x[k], b = factor * x[k + 1], d = factor * x[k + 2], e = factor * x[k + 3];
        for (int i = 0; i < rows; i++)
            y[i] += a * c[i] + b * c[rows + i] + (d * c[2L * rows + i] + e * c[3L * rows + i]);
    }
    for (; k < columns; k++)
        plus(rows, factor * x[k], X + (long)k * rows, y);
}

VECTORISED double dot(int N, const double *x, const double *y)
{
    double sum[8] = {0.0};
    int i = 0;
    for (; i + 8 <= N; i += 8)
        for (int k = 0; k < 8; k++)
            sum[k] += x[i + k] * y[i + k];
    for (; i < N; i++)
        sum[0] += x[i] * y[i];
    return sum[0] + sum[1] + (sum[2] + sum[3]) + (sum[4] + sum[5] + (sum[6] + sum[7]));
}
