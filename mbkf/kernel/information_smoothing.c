/* A smoother that keeps information: Y = P^-1 and y = Y d of an error d, forward, and its smoothed covariance S, backward.
 * Noise G n of a step, n ~ N(0, D), moves d' = Phi d + offset + G n. With M = Phi^-T Y Phi^-1 and W = D^-1 + G'M G,
 *
 *     Y' = M - M G W^-1 G'M + Lambda                  gain = W^-1 G'M,  n given d' ~ N(gain d' + mean, W^-1)
 *     S  = Phi^-1 [(1 - G gain) S' (1 - G gain)' + G W^-1 G'] Phi^-T
 *
 * (Bierman 1977). G has one number per dof, which moves its position and rates alike, and one for each of the
 * components `active`. D's root takes the place of its inverse, so that noise may be zero. */
#include <math.h>
#include <string.h>

#include "bands.h"
#include "call.h"
#include "declared.h"
#include "factor.h"
#include "joints.h"
#include "product.h"
#include "symmetric.h"
#include "transition.h"
#include "vectorised.h"
#include "vectors.h"

/* G, and a root of D: sd of each dof, and the lower triangle `root` (K x K), row by row, of the active components. */
typedef struct {
    int N, nv, orders, K;
    const double *share, *sd, *root;
    const int *active;
} Noise;

enum { HEIGHT = 24 }; /* rows of a triangle whose zeros are left out together */

/* root: lower triangle with root root' = the active part of D (N x N); columns without a part of their own are zero. */
static void noise_root(int N, const double *D, int K, const int *active, double *root)
{
    const double rounding = 1e-13;
    for (int i = 0; i < K; i++)
        for (int j = 0; j <= i; j++) {
            const double *a = root + i * K, *b = root + j * K, own = D[(long)active[i] * N + active[j]];
            double left = own;
            for (int k = 0; k < j; k++)
                left -= a[k] * b[k];
            if (i > j)
                root[i * K + j] = b[j] > 0.0 ? left / b[j] : 0.0;
            else
                root[i * K + i] = left > rounding * own ? sqrt(left) : 0.0;
        }
}

/* w (nv + K) = root' G'x */
VECTORISED static void to_noise(const Noise *g, const double *x, double *w)
{
    memset(w, 0, sizeof *w * (g->nv + g->K));
    for (int order = 0; order <= g->orders; order++)
        plus(g->nv, g->share[order], x + (long)order * g->nv, w);
    for (int j = 0; j < g->nv; j++)
        w[j] *= g->sd[j];
    for (int i = 0; i < g->K; i++)
        plus(i + 1, x[g->active[i]], g->root + i * g->K, w + g->nv);
}

/* root X in place of an upper triangle X (r x r): its last K rows are full in their last K columns. */
static void by_root(const Noise *g, double *X)
{
    const int r = g->nv + g->K;
    for (int p = 0; p < r; p++) {
        double *x = X + (long)p * r, *rest = x + g->nv;
        for (int j = 0; j < g->nv; j++)
            x[j] *= g->sd[j];
        for (int i = p < g->nv ? -1 : g->K - 1; i >= 0; i--) {
            const double *own = g->root + i * g->K;
            double sum = 0.0;
            for (int k = 0; k <= i; k++)
                sum += own[k] * rest[k];
            rest[i] = sum;
        }
    }
}

/* U (N x (nv + K)) = M G root of a symmetric M. */
static void with_noise(const Noise *g, const double *M, double *U)
{
    const int N = g->N, nv = g->nv;
    memset(U, 0, sizeof *U * N * (nv + g->K));
    for (int j = 0; j < nv; j++)
        for (int order = 0; order <= g->orders; order++)
            plus(N, g->share[order] * g->sd[j], M + (long)(order * nv + j) * N, U + (long)j * N);
    for (int i = 0; i < g->K; i++)
        for (int k = 0; k <= i; k++)
            if (g->root[i * g->K + k] != 0.0)
                plus(N, g->root[i * g->K + k], M + (long)g->active[i] * N, U + (long)(nv + k) * N);
}

/* M = X' Y X with X = `back`, symmetric but for rounding; work: 2 N^2 numbers. */
static void moved(int N, const double *Y, const Transition *back, double *M, double *work)
{
    double *first = work, *turned = first + (long)N * N;
    rows_before(N, Y, back, first);
    transposed(N, N, first, N, turned);
    rows_before(N, turned, back, M);
}

/* out (r x rows) = X V' of X (r x r), a triangle but for its last columns from `full` on, and V (rows x r). */
static void triangle_times(int r, int full, const double *X, int rows, const double *V, double *out)
{
    for (int b = 0; b < r; b += HEIGHT) {
        const int height = r - b < HEIGHT ? r - b : HEIGHT, first = b < full ? b : full;
        product(WHOLE, height, rows, r - first, 1.0, X + (long)first * r + b, r, V + (long)first * rows, rows, 0.0,
                NULL, out + b, r);
    }
}

/* Adds Lambda to the part of Y on and below the diagonal. */
static void add_readings(int N, int n, int m, const double *information, const double *rows, double *Y)
{
    for (int j = 0; j < n; j++)
        plus(n, 1.0, information + (long)j * n, Y + (long)j * N);
    for (Band b = {0, 0, 0, 0}; b.end < m;) {
        b = band_from(b.end, m, N, rows);
        const double *H = rows + (long)b.start * N + b.first;
        double *own = Y + (long)b.first * (N + 1);
        const int width = b.last - b.first;
        product(LOWER, width, width, b.end - b.start, 1.0, H, N, H, N, 1.0, own, own, N);
    }
}

int mbkf_information_forward(int N, int nv, int J, int orders, int K, int n, int m, const double *Y, const double *y,
                             const double *offset, const double *A, const double *B, const int *joints,
                             const double *push, const double *rates, const double *share, const double *sd,
                             const double *D, const int *active, const double *information, const double *vector,
                             const double *rows, const double *values, const double *added, double *after,
                             double *gain, double *spread, double *vector_after, double *mean)
{
    const Transition phi = {nv, orders, J, A, B, push, rates, joints};
    const int r = nv + K;
    const long square = (long)N * N, own = (long)r * r;
    const long size = inverse_size(nv, orders) + 3 * square + (long)N * r + 2 * own + (long)K * K + 2L * r + N;
    double *work = are_all_dofs(J, joints, nv) ? workspace(size) : NULL;
    if (!work)
        return 0;
    double *M = work + inverse_size(nv, orders), *free = M + square, *U = free + 2 * square, *T = U + (long)N * r;
    double *X = T + own, *root = X + own, *w = root + (long)K * K, *part = w + r, *moved_y = part + r;
    const Noise g = {N, nv, orders, K, share, sd, root, active};
    Transition back;
    if (inverse(&phi, &back, work))
        return 1;
    noise_root(N, D, K, active, root);
    moved(N, Y, &back, M, free);
    vector_before(N, &back, y, moved_y);
    with_noise(&g, M, U);
    for (int j = 0; j < r; j++) {
        to_noise(&g, U + (long)j * N, T + (long)j * r);
        T[(long)j * (r + 1)] += 1.0;
    }
    to_noise(&g, moved_y, w);
    if (factored(r, T))
        return 2;
    divided(N, r, T, U);
    inverse_transposed(r, T, X);
    for (int k = 0; k < r; k++)
        part[k] = dot(k + 1, X + (long)k * r, w);
    by_root(&g, X);
    triangle_times(r, nv, X, N, U, gain);
    triangle_times(r, nv, X, r, X, spread);
    mirror(r, spread);
    memset(mean, 0, sizeof *mean * r);
    add_columns(r, r, -1.0, X, part, mean);
    add_columns(r, N, -1.0, gain, offset, mean);
    /* y' = Phi^-T y + M offset - V (C^-1 w + V'offset) + lambda */
    memcpy(vector_after, moved_y, sizeof *vector_after * N);
    add_columns(N, N, 1.0, M, offset, vector_after);
    for (int k = 0; k < r; k++)
        part[k] += dot(N, U + (long)k * N, offset);
    add_columns(N, r, -1.0, U, part, vector_after);
    plus(n, 1.0, vector, vector_after);
    plus(N, 1.0, added, vector_after);
    add_columns(N, m, 1.0, rows, values, vector_after);
    product(LOWER, N, N, r, -1.0, U, N, U, N, 1.0, M, after, N);
    add_readings(N, n, m, information, rows, after);
    mirror(N, after);
    return 0;
}

/* X (r x N) -= F G' / 2 */
static void half_less(const Noise *g, const double *F, double *X)
{
    const int nv = g->nv, r = nv + g->K;
    for (int order = 0; order <= g->orders; order++)
        for (int j = 0; j < nv; j++)
            plus(r, -0.5 * g->share[order], F + (long)j * r, X + (long)(order * nv + j) * r);
    for (int k = 0; k < g->K; k++)
        plus(r, -0.5, F + (long)(nv + k) * r, X + (long)g->active[k] * r);
}

/* Z (N x length) -= G E of E (r x length), both row by row; of vectors with length 1. */
static void less_noise(const Noise *g, int length, const double *E, double *Z)
{
    const int nv = g->nv;
    for (int order = 0; order <= g->orders; order++)
        for (int j = 0; j < nv; j++)
            plus(length, -g->share[order], E + (long)j * length, Z + (long)(order * nv + j) * length);
    for (int k = 0; k < g->K; k++)
        plus(length, -1.0, E + (long)(nv + k) * length, Z + (long)g->active[k] * length);
}

int mbkf_information_backward(int N, int nv, int J, int orders, int K, const double *S, const double *d,
                              const double *offset, const double *A, const double *B, const int *joints,
                              const double *push, const double *rates, const double *share, const int *active,
                              const double *gain, const double *spread, const double *mean, double *before,
                              double *step)
{
    const Transition phi = {nv, orders, J, A, B, push, rates, joints};
    const int r = nv + K;
    const long square = (long)N * N, wide = (long)N * r;
    const long size = inverse_size(nv, orders) + 2 * square + 2 * wide + (long)r * r + r + N;
    double *work = are_all_dofs(J, joints, nv) ? workspace(size) : NULL;
    if (!work)
        return 0;
    double *Z = work + inverse_size(nv, orders), *turned = Z + square, *X = turned + square;
    double *E = X + wide, *F = E + wide, *n = F + (long)r * r, *z = n + r;
    const Noise g = {N, nv, orders, K, share, NULL, NULL, active};
    Transition back;
    if (inverse(&phi, &back, work))
        return 1;
    product(WHOLE, r, N, N, 1.0, gain, r, S, N, 0.0, NULL, X, r);
    product(LOWER, r, r, N, 1.0, X, r, gain, r, 1.0, spread, F, r);
    mirror(r, F);
    half_less(&g, F, X);
    transposed(r, N, X, r, E);
    for (long i = 0; i < square; i++)
        Z[i] = 0.5 * S[i];
    less_noise(&g, N, E, Z);
    rows_after(N, Z, &back, before);
    transposed(N, N, before, N, turned);
    rows_after(N, turned, &back, before);
    symmetrise(N, before);
    memcpy(n, mean, sizeof *n * r);
    add_columns(r, N, 1.0, gain, d, n);
    for (int i = 0; i < N; i++)
        z[i] = d[i] - offset[i];
    less_noise(&g, 1, n, z);
    memset(step, 0, sizeof *step * N);
    add_moved(N, &back, z, step);
    return 0;
}
