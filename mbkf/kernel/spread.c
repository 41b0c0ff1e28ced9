/* Parts of the covariance of a state's errors (mbkf/filters/error_covariance.py),
 *
 *     E = S P S + C' skin + rows' rows + [D -D; -D D],   S = diag(size),
 *
 * C' built of the inverse of one frame's information, D on both feet's wrenches for how they share their sum,
 * without E itself: its diagonal, the diagonals of T E T' and U E U', and blocks of three components. The inverse is
 * X X' with an upper triangle X. Rows of T are taken eight at a time: torques of a limb depend on few components, and
 * those on which none of the eight does are left out. P is symmetric, which halves the work. Matrices stand column by
 * column. */
#include <string.h>

#include "call.h"
#include "declared.h"
#include "factor.h"
#include "lanes.h"
#include "vectorised.h"

enum { FOOT = 6 }; /* components of a foot's wrench */

/* Errors of a state (q, v, a, feet's wrenches, rest) of N components. */
typedef struct {
    int N, nv;
    const double *P, *information; /* (N x N), (nv x nv) */
    int n_seen;
    const int *seen;    /* dofs that markers observe */
    const double *size; /* (N) diagonal of S */
    double skin, rate;  /* variance of the markers' skin, and its rate of movement */
    double sharing;     /* multiple by which D is made of P; 0 without */
    int n_rows;
    const double *rows; /* (n_rows x N), row by row */
    double *root;       /* (n_seen x n_seen) X */
    double difference[FOOT][FOOT]; /* D */
} Errors;

enum { BREADTH = 8, HALF = BREADTH / 2 };

/* D: a multiple of P's covariance of half the difference of both feet's wrenches, which come after accelerations. */
static void set_difference(Errors *e, double multiple)
{
    const int right = 3 * e->nv, left = right + FOOT;
    for (int i = 0; i < FOOT; i++)
        for (int j = 0; j < FOOT; j++) {
            const double *of_right = e->P + (long)(right + j) * e->N, *of_left = e->P + (long)(left + j) * e->N;
            const double between = of_left[right + i] + of_right[left + i];
            e->difference[i][j] = 0.25 * multiple * (of_right[right + i] + of_left[left + i] - between);
        }
}

/* diagonal (N) of the errors' covariance, and X. Returns 1 if the information has no factor. work: nv^2 numbers. */
VECTORISED static int error_diagonal(const Errors *e, double *diagonal, double *work)
{
    const int n = e->n_seen, nv = e->nv, N = e->N;
    const double square = e->rate * e->rate;
    double *variance = work;
    for (int j = 0; j < n; j++)
        for (int i = j; i < n; i++)
            work[(long)j * n + i] = e->information[(long)e->seen[j] * nv + e->seen[i]];
    if (factored(n, work))
        return 1;
    inverse_transposed(n, work, e->root);
    memset(variance, 0, sizeof *variance * n);
    for (int k = 0; k < n; k++)
        for (int i = 0; i <= k; i++)
            variance[i] += e->root[(long)k * n + i] * e->root[(long)k * n + i];
    for (int i = 0; i < N; i++)
        diagonal[i] = e->P[(long)i * N + i] * e->size[i] * e->size[i];
    for (int k = 0; k < n; k++) {
        const int dof = e->seen[k];
        diagonal[dof] += e->skin * variance[k];
        diagonal[nv + dof] += square * (e->skin * variance[k]);
        diagonal[2 * nv + dof] += square * square * (e->skin * variance[k]);
    }
    for (int k = 0; k < e->n_rows; k++)
        for (int i = 0; i < N; i++)
            diagonal[i] += e->rows[(long)k * N + i] * e->rows[(long)k * N + i];
    for (int i = 0; i < 2 * FOOT && e->sharing != 0.0; i++)
        diagonal[3 * nv + i] += e->difference[i % FOOT][i % FOOT];
    return 0;
}

/* variance += diagonal of A P A', A (LANES x count) the columns index of a matrix: left of P's diagonal counts twice.
 * count is a multiple of BREADTH. */
VECTORISED static void add_quadratic(int count, const int *index, const Lanes *A, int N, const double *P,
                                     Lanes *variance)
{
    Lanes total = *variance;
    for (int b = 0; b < count; b += BREADTH) {
        Lanes sum[BREADTH];
        const double *column[BREADTH];
        memset(sum, 0, sizeof sum);
        for (int j = 0; j < BREADTH; j++)
            column[j] = P + (long)index[b + j] * N;
        for (int p = 0; p < b; p++)
            for (int j = 0; j < BREADTH; j++)
                add_multiple(sum + j, column[j][index[p]], A + p);
        for (int j = 0; j < BREADTH; j++)
            add_multiple(sum + j, 1.0, sum + j);
        for (int p = b; p < b + BREADTH; p++)
            for (int j = 0; j < BREADTH; j++)
                add_multiple(sum + j, column[j][index[p]], A + p);
        for (int j = 0; j < BREADTH; j++)
            add_product(&total, 1.0, sum + j, A + b + j);
    }
    *variance = total;
}

/* variance += factor times the squares of B X, B (2 LANES x count) the columns index of matrices: swing and quarter. */
VECTORISED static void add_repeated(int count, const int *index, const Lanes *B, int n, const double *X, double factor,
                                    Lanes *variance)
{
    Lanes total = *variance;
    for (int b = count ? index[0] : n; b < n; b += HALF) { /* X is zero below its diagonal */
        Lanes sum[HALF][2];
        const double *column[HALF];
        memset(sum, 0, sizeof sum);
        for (int j = 0; j < HALF; j++)
            column[j] = X + (long)(b + j < n ? b + j : n - 1) * n;
        for (int p = 0; p < count && index[p] < b + HALF; p++)
            for (int j = 0; j < HALF; j++)
                for (int half = 0; half < 2; half++)
                    add_multiple(&sum[j][half], column[j][index[p]], B + 2 * p + half);
        for (int j = 0; j < HALF && b + j < n; j++)
            for (int half = 0; half < 2; half++)
                add_product(&total, factor, &sum[j][half], &sum[j][half]);
    }
    *variance = total;
}

/* variance += square of A (LANES x count) times a row's components index. */
VECTORISED static void add_row(int count, const int *index, const Lanes *A, const double *row, Lanes *variance)
{
    Lanes sum;
    memset(&sum, 0, sizeof sum);
    for (int p = 0; p < count; p++)
        if (row[index[p]] != 0.0)
            add_multiple(&sum, row[index[p]], A + p);
    add_product(variance, 1.0, &sum, &sum);
}

/* variance += diagonal of (A_r - A_l) D (A_r - A_l)', A_r and A_l the columns of A by both feet's wrenches. */
static void add_sharing(const Errors *e, int count, const int *index, const Lanes *A, Lanes *variance)
{
    Lanes apart[FOOT];
    memset(apart, 0, sizeof apart);
    for (int p = count - 1; p >= 0 && index[p] >= 3 * e->nv; p--) {
        const int component = index[p] - 3 * e->nv;
        if (component < 2 * FOOT)
            add_multiple(apart + component % FOOT, component < FOOT ? 1.0 : -1.0, A + p);
    }
    for (int i = 0; i < FOOT; i++)
        for (int j = 0; j < FOOT; j++)
            add_product(variance, e->difference[i][j], apart + i, apart + j);
}

/* Working memory for rows of T: their columns that are not zero, these times S, and their oscillation. */
typedef struct {
    Lanes *own, *sized, *swinging;
    int *index, *seen;
} Columns;

enum { IN_LANES = 4 }; /* Columns take so many times LANES numbers per component, its integers included */

static long columns_size(int N) { return (long)IN_LANES * LANES * (N + BREADTH); }

static Columns columns_in(double *work, int N)
{
    Lanes *at = (Lanes *)work;
    const long room = N + BREADTH;
    int *index = (int *)(at + 3 * room); /* swinging has two for each of N/3 dofs */
    return (Columns){at, at + room, at + 2 * room, index, index + room};
}

/* The columns of T (m x n) that are not zero in some of its rows from first to end, LANES at most; their number. */
VECTORISED static int taken(int m, int n, const double *T, int first, int end, Columns *to)
{
    const int height = end - first;
    int count = 0;
    for (int j = 0; j < n; j++) {
        const double *column = T + (long)j * m + first;
        int i = 0;
        while (i < height && column[i] == 0.0)
            i++;
        if (i == height)
            continue;
        if (height == LANES)
            memcpy(to->own + count, column, sizeof *to->own);
        else {
            memset(to->own + count, 0, sizeof *to->own);
            memcpy(to->own + count, column, sizeof *column * height);
        }
        to->index[count++] = j;
    }
    return count;
}

/* Rows of T on an oscillation: positions and accelerations, which are in opposition, and velocities between them, by
 * those seen dofs on which they depend; the number of these. */
VECTORISED static int oscillation(const Errors *e, int count, Columns *columns)
{
    const int nv = e->nv;
    const double factor[3] = {1.0, e->rate, -e->rate * e->rate};
    int at[3] = {0, 0, 0}, found = 0;
    for (int part = 1; part < 3; part++)
        for (at[part] = at[part - 1]; at[part] < count && columns->index[at[part]] < part * nv;)
            at[part]++;
    for (int k = 0; k < e->n_seen; k++) {
        Lanes *both = columns->swinging + 2 * found;
        int some = 0;
        memset(both, 0, 2 * sizeof *both);
        for (int part = 0; part < 3; part++) {
            const int wanted = part * nv + e->seen[k];
            while (at[part] < count && columns->index[at[part]] < wanted)
                at[part]++;
            if (at[part] < count && columns->index[at[part]] == wanted) {
                add_multiple(both + part % 2, factor[part], columns->own + at[part]);
                some = 1;
            }
        }
        columns->seen[found] = k;
        found += some;
    }
    return found;
}

/* variance (m) of quantities T (m x n, column by column) of the first n components. The last nv rows are grouped from
 * their first one on: their variances are equal to the last digit with rows before them and without. work: columns_size
 * numbers. */
VECTORISED static void error_of(const Errors *e, int m, int n, const double *T, double *variance, double *work)
{
    Columns columns = columns_in(work, e->N);
    for (int first = 0, end; first < m; first = end) {
        const int edge = first < m - e->nv ? m - e->nv : m;
        end = first + LANES < edge ? first + LANES : edge;
        const int count = taken(m, n, T, first, end, &columns);
        const int padded = (count + BREADTH - 1) / BREADTH * BREADTH;
        Lanes found;
        memset(&found, 0, sizeof found);
        memset(columns.sized, 0, sizeof found * padded);
        for (int p = 0; p < count; p++)
            add_multiple(columns.sized + p, e->size[columns.index[p]], columns.own + p);
        for (int p = count; p < padded; p++)
            columns.index[p] = 0;
        add_quadratic(padded, columns.index, columns.sized, e->N, e->P, &found);
        for (int k = 0; k < e->n_rows; k++)
            add_row(count, columns.index, columns.own, e->rows + (long)k * e->N, &found);
        if (e->sharing != 0.0)
            add_sharing(e, count, columns.index, columns.own, &found);
        if (e->skin > 0.0) {
            const int dofs = oscillation(e, count, &columns);
            add_repeated(dofs, columns.seen, columns.swinging, e->n_seen, e->root, e->skin, &found);
        }
        memcpy(variance + first, &found, sizeof *variance * (end - first));
    }
}

/* blocks (n_blocks x 3 x 3) of the errors' covariance, of three components of q each, from `first` on. */
static void error_blocks(const Errors *e, int n_blocks, const int *first, double *blocks)
{
    const int n = e->n_seen;
    for (int b = 0; b < n_blocks; b++) {
        double C[3][3] = {{0.0}};
        int place[3] = {-1, -1, -1};
        for (int k = 0; k < n; k++)
            if (e->seen[k] >= first[b] && e->seen[k] < first[b] + 3)
                place[e->seen[k] - first[b]] = k;
        for (int k = 0; k < n; k++) {
            double x[3];
            for (int i = 0; i < 3; i++)
                x[i] = place[i] < 0 ? 0.0 : e->root[(long)k * n + place[i]];
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++)
                    C[i][j] += x[i] * x[j];
        }
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                const int p = first[b] + i, q = first[b] + j;
                blocks[9 * b + 3 * i + j] = e->P[(long)p * e->N + q] * e->size[p] * e->size[q] + e->skin * C[i][j];
            }
    }
}

int mbkf_error_variances(int N, int nv, int s, int k, int m, int n, int l, int p, int b, const double *P,
                         const double *information, const int *seen, const double *size, double skin, double rate,
                         double sharing, const double *rows, const double *T, const double *U, const int *first,
                         double *diagonal, double *of_T, double *of_U, double *blocks)
{
    const long square = (long)nv * nv, columns = columns_size(N);
    double *root = workspace(square + (square > columns ? square : columns));
    Errors e = {N, nv, P, information, s, seen, size, skin, rate, sharing, k, rows, root, {{0.0}}};
    if (sharing != 0.0)
        set_difference(&e, sharing);
    if (!root || error_diagonal(&e, diagonal, root + square))
        return 1;
    error_of(&e, m, n, T, of_T, root + square);
    error_of(&e, l, p, U, of_U, root + square);
    error_blocks(&e, b, first, blocks);
    return 0;
}
