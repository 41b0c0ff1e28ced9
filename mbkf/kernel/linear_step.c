/* A step of a filter in corrections of a trajectory, about which everything is linear:
 *
 *     d = Phi d + offset,   g = l - Lambda d,   d + P g
 *
 * as mbkf/kernel/smoothing.py computes it without a kernel. */
#include <string.h>

#include "call.h"
#include "declared.h"
#include "joints.h"
#include "transition.h"
#include "vectorised.h"

/* y (N) += X' x of X (m x N), row by row. */
VECTORISED static void add_rows(int N, int m, const double *X, const double *x, double *restrict y)
{
    int k = 0;
    for (; k + 4 <= m; k += 4) {
        const double *r = X + (long)k * N;
        for (int i = 0; i < N; i++)
            y[i] += x[k] * r[i] + x[k + 1] * r[N + i] + (x[k + 2] * r[2 * N + i] + x[k + 3] * r[3 * N + i]);
    }
    for (; k < m; k++)
        for (int i = 0; i < N; i++)
            y[i] += x[k] * X[(long)k * N + i];
}

VECTORISED static double dot(int N, const double *x, const double *y)
{
    double sum[8] = {0.0};
    int i = 0;
    for (; i + 8 <= N; i += 8)
        for (int k = 0; k < 8; k++)
            sum[k] += x[i + k] * y[i + k];
    for (; i < N; i++)
        sum[0] += x[i] * y[i];
    return sum[0] + sum[1] + (sum[2] + sum[3]) + (sum[4] + sum[5] + (sum[6] + sum[7]));
}

void mbkf_linear_step(int N, int n, int m, int nv, int J, int orders, const double *P, const double *before,
                      const double *offset, const double *information, const double *vector, const double *rows,
                      const double *values, const double *added, const double *A, const double *B, const int *joints,
                      const double *push, const double *rates, double *gradient, double *after)
{
    const Transition phi = {nv, orders, J, A, B, push, rates, joints};
    double *innovations = are_all_dofs(J, joints, nv) ? workspace(m) : NULL;
    if (!innovations)
        return;
    memcpy(after, offset, sizeof *after * N);
    add_moved(N, &phi, before, after);
    memcpy(gradient, added, sizeof *gradient * N);
    for (int i = 0; i < n; i++)
        gradient[i] += vector[i] - dot(n, information + (long)i * n, after);
    for (int k = 0; k < m; k++)
        innovations[k] = values[k] - dot(N, rows + (long)k * N, after);
    add_rows(N, m, rows, innovations, gradient);
    add_rows(N, N, P, gradient, after);
}
