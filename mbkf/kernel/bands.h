/* Rows of readings (m x N), most of which are zero outside of a few neighbouring columns; see bands.c. */
#ifndef MBKF_BANDS_H
#define MBKF_BANDS_H

/* Rows from start to end that are zero outside of the same columns, from first to last. */
typedef struct {
    int start, end, first, last;
} Band;

/* The band that begins with a row. */
Band band_from(int start, int m, int N, const double *rows);

#endif
