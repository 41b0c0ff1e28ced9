/* C = keep D + factor A B' of matrices stored column by column; see product.c. */
#ifndef MBKF_PRODUCT_H
#define MBKF_PRODUCT_H

enum { WHOLE = 0, LOWER = 1 };

/* A: (rows x inner), B: (columns x inner), C: (rows x columns), each with the distance of its columns. D: as C, may be
 * C, and is not read if keep is 0. part: LOWER leaves the part of a square C above the diagonal undefined. */
void product(int part, int rows, int columns, int inner, double factor, const double *A, int lda, const double *B,
             int ldb, double keep, const double *D, double *C, int ldc);

/* True if products are made by 512-bit instructions here, and not by BLAS. */
int product_is_own(void);

#endif
