/* Sums and products of vectors, and a matrix times a vector; see vectors.c. */
#ifndef MBKF_VECTORS_H
#define MBKF_VECTORS_H

/* y (N) += a x */
void plus(int N, double a, const double *x, double *y);

/* y (rows) += factor X x, X (rows x columns) column by column. */
void add_columns(int rows, int columns, double factor, const double *X, const double *x, double *restrict y);

/* x' y of vectors of N numbers. */
double dot(int N, const double *x, const double *y);

#endif
