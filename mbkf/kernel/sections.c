/* Loads at a section of the trunk with their derivatives (mbkf/model/trunk_sections.py), of a tree whose segments are
 * those above the section. By way: from the upper part's motion, and that less the residual of the whole body. */
#include <string.h>

#include "call.h"
#include "rotation.h"
#include "tree.h"

enum { ROOT = 6, WAYS = 2 };

/* total (n) += x y */
static void plus(long n, double x, const double *y, double *total)
{
    for (long i = 0; i < n; i++)
        total[i] += x * y[i];
}

/* Adds m x e_j to the columns j of moments m by the dofs of the joint above, whose axes turn with it. */
static void turn(const double *moment, long stride, double *rows)
{
    double across[9];
    cross_matrix(moment, across);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            rows[i * stride + j] += across[3 * i + j];
}

void mbkf_section_state(int N, Tree *tree, const double *q, const double *v, const double *a, const double *carried,
                        const double *transport, int above, const double *residual, const double *by_state,
                        double *wrench, double *moment, double *rows, double *by_root)
{
    const long known = 3L * tree->nv, stride = known + 2 * ROOT;
    const Joint *joint = &tree->joint[above];
    double R[9], *slopes = workspace(ROOT * stride);
    if (!slopes)
        return;
    mbkf_root_dynamics(tree, q, v, a, carried, wrench, slopes);
    for (int i = 0; i < 9; i += 3)
        rotated_back(tree->frames + 12, tree->frames + 12 * above + i, R + i);
    memset(rows, 0, sizeof *rows * WAYS * 3 * N);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < ROOT; j++)
            by_root[ROOT * i + j] = R[3 * i] * transport[j] + R[3 * i + 1] * transport[ROOT + j] +
                                    R[3 * i + 2] * transport[2 * ROOT + j];
    for (int j = 0; j < ROOT; j++)
        wrench[ROOT + j] = wrench[j] - residual[j];
    for (int i = 0; i < 3; i++) {
        const double *own = by_root + ROOT * i;
        double *down = rows + (long)i * N, *up = rows + (long)(3 + i) * N;
        for (int way = 0; way < WAYS; way++)
            moment[3 * way + i] = dot6(own, wrench + ROOT * way);
        for (int j = 0; j < ROOT; j++)
            plus(known, own[j], slopes + j * stride, down);
        memcpy(up, down, sizeof *rows * N);
        for (int j = 0; j < ROOT; j++)
            plus(N, -own[j], by_state + (long)j * N, up);
    }
    for (int way = 0; way < WAYS && joint->kind == SPHERICAL; way++)
        turn(moment + 3 * way, N, rows + 3L * way * N + joint->at_v);
}
