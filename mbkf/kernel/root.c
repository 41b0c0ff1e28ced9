/* The root's six equations ID(q, v, a) - J'w in its own axes, and their derivatives by q, v, a and the wrenches. */
#include "call.h"
#include "dynamics.h"

/* A force and its moment about the root joint in the root's axes, down a column. */
static void in_root_axes(const double *frame, const double *force, double *column, long stride)
{
    double lever[3], moment[3], parts[6];
    cross(frame + 9, force, lever);
    for (int i = 0; i < 3; i++)
        moment[i] = force[3 + i] - lever[i];
    rotated_back(frame, force, parts);
    rotated_back(frame, moment, parts + 3);
    for (int i = 0; i < 6; i++)
        column[i * stride] = parts[i];
}

/* A wrench that is constant in the world turns in the root's axes when these turn. */
static void add_turned(const Tree *tree, const double *wrench, double *by_q, long stride)
{
    for (int i = 0; i < 6; i++) {
        double turning[6];
        cross_force(tree->axes[i], wrench, turning);
        for (int k = 0; k < 6; k++)
            by_q[i * stride + k] -= dot6(tree->axes[k], turning);
    }
}

void mbkf_root_dynamics(Tree *tree, const double *q, const double *v, const double *a, const double *wrench,
                        double *residual, double *by_state)
{
    const long nv = tree->nv, stride = 3 * nv + 12;
    const double *frame = tree->frames + 12;
    double left[6];
    tree_force_derivatives(tree, q, v, a);
    for (long k = 0; k < nv; k++) {
        Derivative *by = &tree->by[k];
        if (k >= 6) /* forces turn with these dofs; the root's axes do not */
            for (int i = 0; i < 6; i++)
                by->force_by_q[i] += by->turned_force[i];
        in_root_axes(frame, by->force_by_q, by_state + k, stride);
        in_root_axes(frame, by->force_by_v, by_state + nv + k, stride);
        in_root_axes(frame, by->force_by_a, by_state + 2 * nv + k, stride);
    }
    for (int i = 0; i < 6; i++) {
        double *by_wrench = by_state + i * stride + 3 * nv;
        left[i] = tree->composite[1].force[i] - wrench[i];
        for (int k = 0; k < 6; k++)
            by_wrench[k] = by_wrench[6 + k] = -tree->axes[i][k];
    }
    in_root_axes(frame, left, residual, 1);
    add_turned(tree, wrench, by_state, stride);
}

void mbkf_law_rows(int m, Tree *tree, const double *q, const double *v, const double *a, const double *wrenches,
                   const double *extra, const double *by_extra, const double *sharp, double *rows,
                   double *innovation)
{
    const int known = 3 * tree->nv + 12, width = known + m;
    double wrench[6], residual[6], *by_state = workspace(6L * known);
    if (!by_state)
        return;
    for (int i = 0; i < 6; i++)
        wrench[i] = wrenches[i] + wrenches[6 + i];
    mbkf_root_dynamics(tree, q, v, a, wrench, residual, by_state);
    for (int i = 0; i < 6; i++) {
        double *row = rows + (long)i * width;
        innovation[i] = -sharp[i] * residual[i];
        for (int j = 0; j < known; j++)
            row[j] = sharp[i] * by_state[(long)i * known + j];
        for (int j = 0; j < m; j++) {
            row[known + j] = by_extra[(long)i * m + j];
            innovation[i] -= row[known + j] * extra[j];
        }
    }
}

void mbkf_centre_of_mass(Tree *tree, const double *q, double *centre)
{
    double mass = 0.0;
    tree_place(tree, q);
    centre[0] = centre[1] = centre[2] = 0.0;
    for (int i = 1; i < tree->joints; i++) {
        const Joint *joint = &tree->joint[i];
        const double *frame = tree->frames + 12 * i, *lever = joint->lever;
        for (int k = 0; k < 3; k++)
            centre[k] += joint->mass * (frame[9 + k] + lever[0] * frame[k] + lever[1] * frame[3 + k] + lever[2] * frame[6 + k]);
        mass += joint->mass;
    }
    for (int k = 0; k < 3; k++)
        centre[k] /= mass;
}
