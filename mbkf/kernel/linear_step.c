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
#include "vectors.h"

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
    add_columns(N, m, 1.0, rows, innovations, gradient);
    add_columns(N, N, 1.0, P, gradient, after);
}
