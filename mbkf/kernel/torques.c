/* Generalised forces of a tree under its feet's wrenches, tau = ID(q, v, a) - sum of J' w, and their derivatives.
 *
 * The force f of all that a joint carries does work along the joint's axes: tau_i = J_i . f. A dof k behind i changes f
 * and not J_i. A dof k before i, or of the same joint, turns both alike; besides, f changes by Y (acceleration by k) +
 * D (velocity by k) as in dynamics.c, and J_i . Y s = s . Y J_i, J_i . D s = s . D'J_i. Dofs of which neither is before
 * the other do not couple. */
#include "dynamics.h"

#include <string.h>

/* X J_k with (J_k x J_i) . w = J_i' X J_k: effect of a rotation by dof k (_turned_wrench of newton_euler.py). */
static void turned_wrench(const double *w, const double *column, double *found)
{
    double moment[3];
    cross(w, column + 3, found);
    cross(w, column, found + 3);
    cross(w + 3, column + 3, moment);
    for (int i = 0; i < 3; i++)
        found[3 + i] += moment[i];
}

/* Angular part of D'J; the linear part is zero. */
static void gyrated(const Composite *one, const double *axis, double *found)
{
    double across[3];
    cross(one->impulse, axis, across);
    rotated_back(one->gyration, axis + 3, found);
    for (int i = 0; i < 3; i++)
        found[i] += 2.0 * across[i];
}

/* Derivatives of dof i's force by the dofs k of a joint before its own, or of its own, and of theirs by dof i. */
static void couple(const Tree *tree, const Joint *joint, int same, int i, const double *gyration, long m,
                   double *by_state)
{
    const long block = tree->nv * m;
    const Derivative *of = &tree->by[i];
    double total[6];
    for (int c = 0; c < 6; c++)
        total[c] = of->force_by_q[c] + of->turned_force[c];
    for (int k = joint->at_v; k < joint->at_v + joint->dofs; k++) {
        const Derivative *by = &tree->by[k];
        const double *axis = tree->axes[k];
        double *down = by_state + k * m + i, *up = by_state + i * m + k;
        down[0] = dot6(by->by_q, of->force_by_a) + dot3(by->drag + 3, gyration);
        down[block] = dot6(by->by_v, of->force_by_a) + dot3(axis + 3, gyration);
        down[2 * block] = dot6(axis, of->force_by_a);
        if (same)
            continue;
        up[0] = dot6(axis, total);
        up[block] = dot6(axis, of->force_by_v);
        up[2 * block] = down[2 * block];
    }
}

/* Subtracts the feet's wrenches. */
static void subtract_wrenches(const Tree *tree, const char *moves, const double *wrenches, double *tau)
{
    for (int foot = 0; foot < 2; foot++)
        for (int k = 0; k < tree->nv; k++)
            if (moves[(long)foot * tree->nv + k])
                tau[k] -= dot6(tree->axes[k], wrenches + 6 * foot);
}

/* The same for by_state and one foot, whose wrench is constant in the world while dofs before turn an axis. */
static void subtract_derivatives(const Tree *tree, const char *own, const double *w, long m, double *by_state,
                                 double *by_wrench)
{
    const int nv = tree->nv;
    for (int n = 1; n < tree->joints; n++) {
        const Joint *joint = &tree->joint[n];
        if (!joint->dofs || !own[joint->at_v])
            continue;
        for (int k = joint->at_v; k < joint->at_v + joint->dofs; k++) {
            double change[6];
            turned_wrench(w, tree->axes[k], change);
            for (int c = 0; c < 6; c++)
                by_wrench[c * m + k] = -tree->axes[k][c];
            for (int i = joint->at_v; i < nv; i++)
                if (own[i])
                    by_state[k * m + i] -= dot6(tree->axes[i], change);
        }
    }
}

void mbkf_generalised_forces(Tree *tree, const double *q, const double *v, const double *a, const char *moves,
                             const double *wrenches, double *tau)
{
    tree_forces(tree, q, v, a);
    for (int n = 1; n < tree->joints; n++) {
        const Joint *joint = &tree->joint[n];
        for (int k = joint->at_v; k < joint->at_v + joint->dofs; k++)
            tau[k] = dot6(tree->axes[k], tree->composite[n].force);
    }
    subtract_wrenches(tree, moves, wrenches, tau);
}

void mbkf_motion_forces(int frames, Tree *tree, const double *q, const double *v, const double *a, const char *moves,
                        const double *wrenches, double *tau)
{
    for (int t = 0; t < frames; t++) {
        mbkf_generalised_forces(tree, q, v, a, moves, wrenches, tau);
        q += tree->nq, v += tree->nv, a += tree->nv, wrenches += 12, tau += tree->nv;
    }
}

void tree_torques(Tree *tree, const double *q, const double *v, const double *a, const char *moves,
                  const double *wrenches, long m, double *tau, double *by_state)
{
    const long nv = tree->nv;
    tree_force_derivatives(tree, q, v, a);
    for (int n = 1; n < tree->joints; n++) {
        const Joint *joint = &tree->joint[n];
        const Composite *one = &tree->composite[n];
        for (int i = joint->at_v; i < joint->at_v + joint->dofs; i++) {
            double gyration[3];
            tau[i] = dot6(tree->axes[i], one->force);
            gyrated(one, tree->axes[i], gyration);
            couple(tree, joint, 1, i, gyration, m, by_state);
            for (int before = joint->parent; before; before = tree->joint[before].parent)
                couple(tree, &tree->joint[before], 0, i, gyration, m, by_state);
        }
    }
    subtract_wrenches(tree, moves, wrenches, tau);
    for (int foot = 0; foot < 2; foot++)
        subtract_derivatives(tree, moves + foot * nv, wrenches + 6 * foot, m, by_state,
                             by_state + (3 * nv + 6 * foot) * m);
}

void mbkf_torque_derivatives(Tree *tree, const double *q, const double *v, const double *a, const char *moves,
                             const double *wrenches, double *tau, double *by_state, double *jacobian)
{
    const long nv = tree->nv;
    memset(by_state, 0, sizeof *by_state * nv * (3 * nv + 12));
    tree_torques(tree, q, v, a, moves, wrenches, nv, tau, by_state);
    memcpy(jacobian, tree->axes, sizeof *tree->axes * nv);
}
