/* Matrices and their transposes, in tiles that stay in the caches; see symmetric.c. */
#ifndef MBKF_SYMMETRIC_H
#define MBKF_SYMMETRIC_H

/* Copies the part above the diagonal, row by row, to the part below. */
void mirror(int N, double *X);

/* B (columns x rows) = A' of a matrix (rows x columns), both stored column by column; B is not A. */
void transposed(int rows, int columns, const double *A, int lda, double *B);

/* X + X' in place of X: exactly symmetric. */
void symmetrise(int N, double *X);

#endif
