/* C = keep C + factor A B' of matrices stored column by column; see product.c. */
#ifndef MBKF_PRODUCT_H
#define MBKF_PRODUCT_H

enum { WHOLE = 0, LOWER = 1 };

/* A: (rows x inner), B: (columns x inner), C: (rows x columns), each with the distance of its columns.
 * part: LOWER, of a square C, leaves what stands above the diagonal undefined. */
void product(int part, int rows, int columns, int inner, double factor, const double *A, int lda, const double *B,
             int ldb, double keep, double *C, int ldc);

/* Whether product has instructions of its own here, rather than BLAS's. */
int product_is_own(void);

#endif
