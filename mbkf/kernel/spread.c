/* Parts of the covariance of a state's errors (mbkf/filters/error_covariance.py),
 *
 *     E = S P S + C' skin + rows' rows,   S = diag(size), C' built of the inverse of one frame's information,
 *
 * without E itself: its diagonal, the diagonals of T E T' and U E U', and blocks of three components. P is symmetric,
 * which halves T S P S T'; the inverse is W'W with a triangle W. Matrices stand column by column. */
#include <string.h>

#include "call.h"
#include "declared.h"
#include "factor.h"
#include "product.h"
#include "vectorised.h"

/* Errors of a state (q, v, a, rest) of N components. */
typedef struct {
    int N, nv;
    const double *P, *information; /* (N x N), (nv x nv) */
    int n_seen;
    const int *seen;    /* dofs that markers observe */
    const double *size; /* (N) diagonal of S */
    double skin, rate;  /* variance of the markers' skin, and its rate of movement */
    int n_rows;
    const double *rows; /* (n_rows x N), row by row */
} Errors;

enum { BLOCK = 24 };

/* W = L^-1 of a lower triangle L (n x n) */
VECTORISED static void inverted(int n, const double *L, double *W)
{
    memset(W, 0, sizeof(double) * n * n);
    for (int j = 0; j < n; j++) {
        double *x = W + (long)j * n;
        x[j] = 1.0;
        for (int k = j; k < n; k++) {
            const double *l = L + (long)k * n, found = x[k] / l[k];
            x[k] = found;
            for (int i = k + 1; i < n; i++)
                x[i] -= found * l[i];
        }
    }
}

/* x . y */
VECTORISED static double dot(int n, const double *x, const double *y)
{
    double sum[4] = {0.0, 0.0, 0.0, 0.0};
    int i = 0;
    for (; i + 4 <= n; i += 4)
        for (int k = 0; k < 4; k++)
            sum[k] += x[i + k] * y[i + k];
    for (; i < n; i++)
        sum[0] += x[i] * y[i];
    return sum[0] + sum[1] + (sum[2] + sum[3]);
}

/* total (n) += x y, number by number, summed over columns one after the other */
VECTORISED static void add_products(int n, int columns, const double *x, const double *y, double *total)
{
    for (int j = 0; j < columns; j++, x += n, y += n)
        for (int i = 0; i < n; i++)
            total[i] += x[i] * y[i];
}

/* diagonal (N) of the errors' covariance, and root (n_seen x nv): W, column by column, 0 in columns that are not seen.
 * Returns 1 if the information has no factor. work: 2 nv^2 numbers. */
static int error_diagonal(const Errors *e, double *root, double *diagonal, double *work)
{
    const int n = e->n_seen, nv = e->nv, N = e->N;
    double *L = work, *W = work + (long)n * n;
    for (int j = 0; j < n; j++)
        for (int i = j; i < n; i++)
            L[(long)j * n + i] = e->information[(long)e->seen[j] * nv + e->seen[i]];
    if (factored(n, L))
        return 1;
    inverted(n, L, W);
    memset(root, 0, sizeof(double) * n * nv);
    for (int i = 0; i < N; i++)
        diagonal[i] = e->P[(long)i * N + i] * e->size[i] * e->size[i];
    for (int k = 0; k < n; k++) {
        const int dof = e->seen[k];
        const double square = e->rate * e->rate;
        const double skin = e->skin * dot(n, W + (long)k * n, W + (long)k * n);
        memcpy(root + (long)dof * n, W + (long)k * n, sizeof(double) * n);
        diagonal[dof] += skin;
        diagonal[nv + dof] += square * skin;
        diagonal[2 * nv + dof] += square * square * skin;
    }
    add_products(N, e->n_rows, e->rows, e->rows, diagonal);
    return 0;
}

/* variance += diagonal of T P T' for T (m x n): what stands left of P's diagonal counts twice. Y: (m x BLOCK) */
static void symmetric_form(int m, int n, const double *T, int N, const double *P, double *variance, double *Y)
{
    for (int b = 0; b < n; b += BLOCK) {
        const int width = n - b < BLOCK ? n - b : BLOCK;
        const double *own = T + (long)b * m;
        if (b)
            product(WHOLE, m, width, b, 2.0, T, m, P + b, N, 0.0, NULL, Y, m);
        product(WHOLE, m, width, width, 1.0, own, m, P + (long)b * N + b, N, b ? 1.0 : 0.0, Y, Y, m);
        add_products(m, width, own, Y, variance);
    }
}

/* T on an oscillation: positions and accelerations, which are in opposition, and velocities between them: (2 m x nv). */
VECTORISED static void oscillation(int m, int n, int nv, double rate, const double *T, double *parts)
{
    const int has_v = n >= 2 * nv, has_a = n >= 3 * nv;
    for (int j = 0; j < nv; j++) {
        const double *q = T + (long)j * m, *v = q + (long)nv * m, *a = v + (long)nv * m;
        double *swing = parts + 2L * j * m, *quarter = swing + m;
        for (int i = 0; i < m; i++)
            swing[i] = has_a ? q[i] - rate * rate * a[i] : q[i];
        for (int i = 0; i < m; i++)
            quarter[i] = has_v ? rate * v[i] : 0.0;
    }
}

/* variance (m) += factor times the squares of columns of 2 m numbers, both halves added */
VECTORISED static void folded(int m, int columns, double factor, const double *R, double *variance)
{
    for (int j = 0; j < columns; j++, R += 2L * m)
        for (int i = 0; i < m; i++)
            variance[i] += factor * (R[i] * R[i] + R[m + i] * R[m + i]);
}

/* variance += skin times the squares of parts W' (2 m x n_seen), where row k of W ends at the seen dof k */
static void repeated(const Errors *e, const double *root, int m, const double *parts, double *variance, double *R)
{
    const int rows = 2 * m;
    for (int b = 0; b < e->n_seen; b += BLOCK) {
        const int width = e->n_seen - b < BLOCK ? e->n_seen - b : BLOCK;
        const int inner = e->seen[b + width - 1] + 1;
        product(WHOLE, rows, width, inner, 1.0, parts, rows, root + b, e->n_seen, 0.0, NULL, R, rows);
        folded(m, width, e->skin, R, variance);
    }
}

/* T with its columns multiplied by size. */
VECTORISED static void scaled(int m, int columns, const double *size, const double *T, double *sized)
{
    for (int j = 0; j < columns; j++, T += m, sized += m)
        for (int i = 0; i < m; i++)
            sized[i] = size[j] * T[i];
}

VECTORISED static void added(int m, double factor, const double *x, double *y)
{
    for (int i = 0; i < m; i++)
        y[i] += factor * x[i];
}

static long error_work(int m, int n, int nv) { return (long)m * (n + 2L * nv + 2 * BLOCK); }

/* variance (m) of quantities T (m x n, column by column) of the first n components. work: error_work numbers. */
static void error_of(const Errors *e, const double *root, int m, int n, const double *T, double *variance,
                     double *work)
{
    double *sized = work, *parts = sized + (long)m * n, *Y = parts + 2L * m * e->nv;
    memset(variance, 0, sizeof(double) * m);
    scaled(m, n, e->size, T, sized);
    symmetric_form(m, n, sized, e->N, e->P, variance, Y);
    if (e->n_seen && e->skin > 0.0) {
        oscillation(m, n, e->nv, e->rate, T, parts);
        repeated(e, root, m, parts, variance, Y);
    }
    for (int k = 0; k < e->n_rows; k++) {
        const double *row = e->rows + (long)k * e->N;
        int some = 0;
        memset(Y, 0, sizeof(double) * m);
        for (int j = 0; j < n; j++)
            if (row[j] != 0.0) {
                added(m, row[j], T + (long)j * m, Y);
                some = 1;
            }
        if (some)
            add_products(m, 1, Y, Y, variance);
    }
}

/* blocks (n_blocks x 3 x 3) of the errors' covariance, of three components of q each, from `first` on. */
static void error_blocks(const Errors *e, const double *root, int n_blocks, const int *first, double *blocks)
{
    const int n = e->n_seen;
    for (int b = 0; b < n_blocks; b++)
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                const int p = first[b] + i, q = first[b] + j;
                blocks[9 * b + 3 * i + j] = e->P[(long)p * e->N + q] * e->size[p] * e->size[q] +
                                            e->skin * dot(n, root + (long)p * n, root + (long)q * n);
            }
}

int mbkf_error_variances(int N, int nv, int s, int k, int m, int n, int l, int p, int b, const double *P,
                         const double *information, const int *seen, const double *size, double skin, double rate,
                         const double *rows, const double *T, const double *U, const int *first, double *diagonal,
                         double *of_T, double *of_U, double *blocks)
{
    const Errors e = {N, nv, P, information, s, seen, size, skin, rate, k, rows};
    const long square = (long)nv * nv;
    double *root = workspace(3 * square + error_work(m, n, nv) + error_work(l, p, nv));
    if (!root || error_diagonal(&e, root, diagonal, root + square))
        return 1;
    error_of(&e, root, m, n, T, of_T, root + square);
    error_of(&e, root, l, p, U, of_U, root + square);
    error_blocks(&e, root, b, first, blocks);
    return 0;
}
