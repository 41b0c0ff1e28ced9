/* Cholesky factors, block of columns by block: what stands left of a block is taken off by one product. LAPACK's routine,
 * made for larger matrices, takes twice as long; it does it where products are BLAS's. */
#include "factor.h"

#include <math.h>
#include <string.h>

#include "blas.h"
#include "product.h"
#include "vectorised.h"

enum { WIDTH = 8 };

/* The lower factor of a block of columns (rows x width), whose left neighbours are taken off. */
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
