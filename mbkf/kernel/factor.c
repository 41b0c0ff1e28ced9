/* Cholesky factors and division by them, block of columns by block: one product subtracts all columns left of a block.
 * At a body's size that is faster than LAPACK's routines, which are used where BLAS multiplies matrices. */
#include "factor.h"

#include <math.h>
#include <string.h>

#include "blas.h"
#include "product.h"
#include "vectorised.h"

enum { WIDTH = 8 };

/* Lower factor of a block of columns (rows x width), from which its left neighbours are subtracted. */
VECTORISED static int panel(int rows, int width, double *A, int lda)
{
    for (int j = 0; j < width; j++) {
        double *column = A + (long)j * lda;
        if (!(column[j] > 0.0))
            return 1;
        const double root = sqrt(column[j]);
        column[j] = root;
        for (int i = j + 1; i < rows; i++)
            column[i] /= root;
        for (int k = j + 1; k < width; k++) {
            double *next = A + (long)k * lda;
            const double factor = column[k];
            for (int i = k; i < rows; i++)
                next[i] -= factor * column[i];
        }
    }
    return 0;
}

/* X (rows x width) divided by a block of L. */
VECTORISED static void columns_divided(int rows, int width, const double *L, int ldl, double *X, int ldx)
{
    for (int j = 0; j < width; j++) {
        double *column = X + (long)j * ldx;
        const double by = L[(long)j * ldl + j];
        for (int k = 0; k < j; k++) {
            const double *before = X + (long)k * ldx, factor = L[(long)k * ldl + j];
            for (int i = 0; i < rows; i++)
                column[i] -= factor * before[i];
        }
        for (int i = 0; i < rows; i++)
            column[i] /= by;
    }
}

int factored(int n, double *A)
{
    int failed = 0;
    if (!n)
        return 0;
    if (!product_is_own())
        blas.dpotrf("l", &n, A, &n, &failed);
    for (int b = 0; product_is_own() && b < n && !failed; b += WIDTH) {
        const int width = n - b < WIDTH ? n - b : WIDTH;
        double *own = A + (long)b * n + b;
        if (b)
            product(WHOLE, n - b, width, b, -1.0, A + b, n, A + b, n, 1.0, own, own, n);
        failed = panel(n - b, width, own, n);
    }
    for (int j = 1; j < n; j++)
        memset(A + (long)j * n, 0, sizeof *A * j);
    return failed != 0;
}

void divided(int rows, int n, const double *L, double *X)
{
    double one = 1.0;
    if (!product_is_own()) {
        blas.dtrsm("r", "l", "t", "n", &rows, &n, &one, (double *)L, &n, X, &rows);
        return;
    }
    for (int b = 0; b < n; b += WIDTH) {
        const int width = n - b < WIDTH ? n - b : WIDTH;
        double *own = X + (long)b * rows;
        if (b)
            product(WHOLE, rows, width, b, -1.0, X, rows, L + b, n, 1.0, own, own, rows);
        columns_divided(rows, width, L + (long)b * n + b, n, own, rows);
    }
}

void inverse_transposed(int n, const double *L, double *X)
{
    double one = 1.0;
    memset(X, 0, sizeof *X * n * n);
    for (int i = 0; i < n; i++)
        X[(long)i * n + i] = 1.0;
    if (n && !product_is_own()) {
        blas.dtrsm("r", "l", "t", "n", &n, &n, &one, (double *)L, &n, X, &n);
        return;
    }
    for (int b = 0; b < n; b += WIDTH) {
        const int width = n - b < WIDTH ? n - b : WIDTH, rows = b + width; /* X is zero below its diagonal */
        double *own = X + (long)b * n;
        if (b)
            product(WHOLE, b, width, b, -1.0, X, n, L + b, n, 1.0, own, own, n);
        columns_divided(rows, width, L + (long)b * n + b, n, own, n);
    }
}
