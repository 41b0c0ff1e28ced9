/* Rows of readings (m x N), of which most are zero but in a few neighbouring columns; see bands.c. */
#ifndef MBKF_BANDS_H
#define MBKF_BANDS_H

/* Rows from start to end that are zero outside of the same columns, from first to last. */
typedef struct {
    int start, end, first, last;
} Band;

/* The next band from a row on. */
Band band_from(int start, int m, int N, const double *rows);

/* B (columns x rows) = A' of a matrix (rows x columns), both stored column by column. */
void transposed(int rows, int columns, const double *A, int lda, double *B);

#endif
