/* Cholesky factors of matrices of a body's size; see factor.c. Matrices stand column by column. */
#ifndef MBKF_FACTOR_H
#define MBKF_FACTOR_H

/* Lower factor L of A = L L' (n x n) in place of A, whose lower triangle alone is read; zero right of the diagonal.
 * Returns 1 if A is not positive definite, else 0. */
int factored(int n, double *A);

/* X L^-T (rows x n) in place of X. */
void divided(int rows, int n, const double *L, double *X);

/* X (n x n) = L^-T, an upper triangle. */
void inverse_transposed(int n, const double *L, double *X);

#endif
