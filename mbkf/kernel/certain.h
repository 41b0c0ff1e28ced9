/* Components of a state whose value is certain: their rows of its covariance are zero, and no reading changes them.
 * Products leave them out; see certain.c. */
#ifndef MBKF_CERTAIN_H
#define MBKF_CERTAIN_H

/* Numbers of the components whose rows of A (N x N), or of B where it is not NULL, are not zero. Returns their count. */
int uncertain(int N, const double *A, const double *B, int *numbers);

/* of (rows x columns), row by row, from M with `length` numbers a row: some of its rows, all of them for NULL. */
void pick(int rows, const int *row, int columns, const int *column, int length, const double *M, double *of);

/* whole (N x N) with `own` (count x count) in the numbered rows and columns, and zeros elsewhere. */
void put(int count, const int *numbers, const double *own, int N, double *whole);

#endif
