/* Parts of matrices without the components that are certain. */
#include "certain.h"

#include <stddef.h>
#include <string.h>

static int is_zero(int N, const double *row)
{
    for (int j = 0; j < N; j++)
        if (row[j] != 0.0)
            return 0;
    return 1;
}

int uncertain(int N, const double *A, const double *B, int *numbers)
{
    int count = 0;
    for (int i = 0; i < N; i++) {
        const long row = (long)i * N;
        if (A[row + i] != 0.0 || !is_zero(N, A + row) || (B && !is_zero(N, B + row)))
            numbers[count++] = i;
    }
    return count;
}

void pick(int rows, const int *row, int columns, const int *column, int length, const double *M, double *of)
{
    for (int i = 0; i < rows; i++) {
        const double *from = M + (long)(row ? row[i] : i) * length;
        for (int j = 0; j < columns; j++)
            *of++ = from[column[j]];
    }
}

void put(int count, const int *numbers, const double *own, int N, double *whole)
{
    memset(whole, 0, sizeof *whole * N * N);
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            whole[(long)numbers[i] * N + numbers[j]] = *own++;
}
