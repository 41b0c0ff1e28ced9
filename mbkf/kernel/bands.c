/* Most rows read wrenches alone: products with their bands take a fraction of the time. Rows whose bands differ by less
 * than a tenth of the state form one band. */
#include "bands.h"

static void columns_of(const double *row, int N, int *first, int *last)
{
    int a = 0, b = N;
    while (a < N && row[a] == 0.0)
        a++;
    while (b > a && row[b - 1] == 0.0)
        b--;
    *first = a < N ? a : 0;
    *last = a < N ? b : 1;
}

Band band_from(int start, int m, int N, const double *rows)
{
    Band band = {start, start + 1, 0, N};
    columns_of(rows + (long)start * N, N, &band.first, &band.last);
    for (; band.end < m; band.end++) {
        int first, last;
        columns_of(rows + (long)band.end * N, N, &first, &last);
        const int least = first < band.first ? first : band.first, most = last > band.last ? last : band.last;
        if (most - least > last - first + N / 10 || most - least > band.last - band.first + N / 10)
            break;
        band.first = least;
        band.last = most;
    }
    return band;
}
