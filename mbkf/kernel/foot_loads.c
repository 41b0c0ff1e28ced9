/* Wrenches that two feet carry as states, in the world: force f, and moment about a point p, with derivatives by states
 * and configuration. With R and o the foot's axes and origin, x where the force acts in its axes, s the states,
 *
 *     forces in world axes    f = s_f,     moment = R s_m + (R x + o - p) x f
 *     in the foot's axes      f = R s_f,   moment = R s_m + (R x + o - p) x f */
#include <string.h>

#include "rotation.h"
#include "tree.h"

/* A 3 x 3 block, row by row, of a foot's 6 x 12 derivatives by both feet's states. */
static void put(const double *block, double *rows, int row, int column)
{
    for (int i = 0; i < 3; i++)
        memcpy(rows + 12 * (row + i) + column, block + 3 * i, 3 * sizeof *block);
}

/* R row by row. */
static void across(const double *axes, double *R)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            R[3 * i + j] = axes[3 * j + i];
}

static void by_states(const double *axes, const double *arm, int own_axes, int column, double *rows)
{
    static const double one[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    double R[9], X[9], block[9];
    across(axes, R);
    cross_matrix(arm, X);
    put(own_axes ? R : one, rows, 0, column);
    if (own_axes)
        matrix_product(X, R, block);
    else
        memcpy(block, X, sizeof block);
    put(block, rows, 3, column);
    put(R, rows, 3, column + 3);
}

void mbkf_foot_wrenches(Tree *tree, const double *q, const int *joint_ids, const double *levers, int own_axes,
                        const double *state, const double *points, double *wrench, double *by_state, double *by_q)
{
    const long nv = tree->nv;
    tree_place(tree, q);
    memset(by_state, 0, 144 * sizeof *by_state);
    memset(by_q, 0, 12 * nv * sizeof *by_q);
    for (int foot = 0; foot < 2; foot++) {
        const double *frame = tree->frames + 12 * joint_ids[foot], *s = state + 6 * foot;
        double turned[3], lever[3], arm[3], moment[3], *f = wrench + 6 * foot, *rows = by_q + 6 * foot * nv;
        if (own_axes)
            rotated(frame, s, f);
        else
            memcpy(f, s, 3 * sizeof *f);
        rotated(frame, s + 3, turned);
        rotated(frame, levers + 3 * foot, lever);
        for (int i = 0; i < 3; i++)
            arm[i] = lever[i] + frame[9 + i] - points[3 * foot + i];
        cross(arm, f, moment);
        for (int i = 0; i < 3; i++)
            f[3 + i] = turned[i] + moment[i];
        by_states(frame, arm, own_axes, 6 * foot, by_state + 72 * foot);
        for (int joint = joint_ids[foot]; joint; joint = tree->joint[joint].parent)
            for (int d = tree->joint[joint].at_v; d < tree->joint[joint].at_v + tree->joint[joint].dofs; d++) {
                const double *axis = tree->axes[d], *spin = axis + 3;
                double moved[3], place[3], change[3], force[3] = {0.0, 0.0, 0.0}, part[3];
                for (int i = 0; i < 3; i++)
                    place[i] = lever[i] + frame[9 + i];
                cross(spin, place, moved);
                for (int i = 0; i < 3; i++)
                    moved[i] += axis[i];
                cross(spin, turned, change);
                cross(moved, f, part);
                if (own_axes)
                    cross(spin, f, force);
                for (int i = 0; i < 3; i++)
                    change[i] += part[i];
                cross(arm, force, part);
                for (int i = 0; i < 3; i++) {
                    rows[i * nv + d] = force[i];
                    rows[(3 + i) * nv + d] = change[i] + part[i];
                }
            }
    }
}
