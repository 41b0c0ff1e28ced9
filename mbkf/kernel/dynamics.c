/* Inverse dynamics with derivatives, all in world axes about the world's origin: motions from the root to the leaves,
 * then inertias and forces of all that a joint carries from the leaves to the root (as S. Singh, R. Russell,
 * P. Wensing, IEEE Robotics and Automation Letters 7, 2022, 1783-1790).
 *
 * A segment's force f = Y a + v x* Y v. Where its motion v changes by s and its acceleration stays,
 *     df = v x* Y s + s x* Y v = D s + Y (v x s),   D = [0, -2 [p]x; 0, G],
 * p its linear momentum, G = 2 (h.u) 1 - 2 u h' + [w]x (2 I - tr(I) 1) its gyration matrix, of u and w the linear and
 * angular velocity, h and I the first and second moments of its mass. D, as Y and f, adds up over segments. */
#include "dynamics.h"

#include <string.h>

void segment_inertia(const Joint *joint, const double *R, Inertia *inertia)
{
    const double m = joint->mass;
    double c[3], half[9], I[6], *second = inertia->second;
    rotated(R, joint->lever, c);
    for (int i = 0; i < 3; i++) {
        c[i] += R[9 + i];
        rotated(R, joint->inertia + 3 * i, half + 3 * i);
    }
    for (int i = 0, k = 0; i < 3; i++)
        for (int j = i; j < 3; j++, k++)
            I[k] = half[i] * R[j] + half[3 + i] * R[3 + j] + half[6 + i] * R[6 + j];
    inertia->mass = m;
    for (int i = 0; i < 3; i++)
        inertia->first[i] = m * c[i];
    second[0] = I[0] + m * (c[1] * c[1] + c[2] * c[2]);
    second[1] = I[1] - m * c[0] * c[1];
    second[2] = I[2] - m * c[0] * c[2];
    second[3] = I[3] + m * (c[0] * c[0] + c[2] * c[2]);
    second[4] = I[4] - m * c[1] * c[2];
    second[5] = I[5] + m * (c[0] * c[0] + c[1] * c[1]);
}

/* G of the above, column by column. */
static void set_gyration(const Inertia *inertia, const double *velocity, double *G)
{
    const double *h = inertia->first, *I = inertia->second, *u = velocity, *w = velocity + 3;
    const double along = 2.0 * dot3(h, u), trace = I[0] + I[3] + I[5];
    const double S[9] = {2.0 * I[0] - trace, 2.0 * I[1],         2.0 * I[2], /* columns */
                         2.0 * I[1],         2.0 * I[3] - trace, 2.0 * I[4],
                         2.0 * I[2],         2.0 * I[4],         2.0 * I[5] - trace};
    for (int j = 0; j < 3; j++) {
        cross(w, S + 3 * j, G + 3 * j);
        for (int i = 0; i < 3; i++)
            G[3 * j + i] -= 2.0 * u[i] * h[j];
        G[4 * j] += along;
    }
}

static void set_motion(const Tree *tree, const Joint *joint, const double *v, const double *a, Composite *one)
{
    const Composite *parent = &tree->composite[joint->parent];
    double velocity[6] = {0}, acceleration[6] = {0}, turning[6];
    for (int k = joint->at_v; k < joint->at_v + joint->dofs; k++)
        for (int i = 0; i < 6; i++) {
            velocity[i] += tree->axes[k][i] * v[k];
            acceleration[i] += tree->axes[k][i] * a[k];
        }
    cross_motion(parent->velocity, velocity, turning);
    for (int i = 0; i < 6; i++) {
        one->velocity[i] = parent->velocity[i] + velocity[i];
        one->acceleration[i] = parent->acceleration[i] + acceleration[i] + turning[i];
    }
}

static void set_force(Composite *one)
{
    double moving[6], centrifugal[6];
    momentum(&one->inertia, one->velocity, moving);
    cross_force(one->velocity, moving, centrifugal);
    momentum(&one->inertia, one->acceleration, one->force);
    for (int i = 0; i < 6; i++)
        one->force[i] += centrifugal[i];
    memcpy(one->impulse, moving, sizeof one->impulse);
}

/* From the root to the leaves: motion, inertia and force of every segment by itself. */
static void set_segments(Tree *tree, const double *v, const double *a)
{
    Composite *world = &tree->composite[0];
    memset(tree->composite, 0, tree->joints * sizeof *tree->composite);
    for (int i = 0; i < 6; i++)
        world->acceleration[i] = -tree->gravity[i];
    for (int i = 1; i < tree->joints; i++) {
        Composite *one = &tree->composite[i];
        set_motion(tree, &tree->joint[i], v, a, one);
        if (tree->joint[i].mass == 0.0)
            continue;
        segment_inertia(&tree->joint[i], tree->frames + 12 * i, &one->inertia);
        set_gyration(&one->inertia, one->velocity, one->gyration);
        set_force(one);
    }
}

/* force += D s. */
static void add_gyration(const Composite *one, const double *s, double *force)
{
    double across[3], along[3];
    cross(s + 3, one->impulse, across);
    rotated(one->gyration, s + 3, along);
    for (int i = 0; i < 3; i++) {
        force[i] += 2.0 * across[i];
        force[3 + i] += along[i];
    }
}

/* Derivatives by a dof whose axis moves with joint one, behind the joint before. */
static void differentiate(const Composite *one, const Composite *before, const double *axis, Derivative *by)
{
    double own[6], pulled[6], dragged[6];
    cross_motion(one->velocity, axis, own);
    cross_motion(before->velocity, axis, by->drag);
    cross_motion(before->acceleration, axis, pulled);
    cross_motion(before->velocity, by->drag, dragged);
    for (int i = 0; i < 6; i++) {
        by->by_v[i] = own[i] + by->drag[i];
        by->by_q[i] = pulled[i] + dragged[i];
    }
    momentum(&one->inertia, axis, by->force_by_a);
    momentum(&one->inertia, by->by_v, by->force_by_v);
    momentum(&one->inertia, by->by_q, by->force_by_q);
    add_gyration(one, axis, by->force_by_v);
    add_gyration(one, by->drag, by->force_by_q);
    cross_force(axis, one->force, by->turned_force);
}

void tree_forces(Tree *tree, const double *q, const double *v, const double *a)
{
    tree_place(tree, q);
    set_segments(tree, v, a);
    for (int i = tree->joints - 1; i > 0; i--) {
        const int parent = tree->joint[i].parent;
        for (int k = 0; parent && k < 6; k++)
            tree->composite[parent].force[k] += tree->composite[i].force[k];
    }
}

void tree_force_derivatives(Tree *tree, const double *q, const double *v, const double *a)
{
    tree_place(tree, q);
    set_segments(tree, v, a);
    for (int i = tree->joints - 1; i > 0; i--) {
        const Joint *joint = &tree->joint[i];
        Composite *before = &tree->composite[joint->parent];
        for (int k = joint->at_v; k < joint->at_v + joint->dofs; k++)
            differentiate(&tree->composite[i], before, tree->axes[k], &tree->by[k]);
        if (joint->parent)
            accumulate(before, &tree->composite[i]);
    }
}

void tree_part(const Tree *tree, const Joint *part, Composite *one)
{
    *one = tree->composite[1]; /* it moves as the root does */
    segment_inertia(part, tree->frames + 12, &one->inertia);
    set_force(one);
}

void tree_upper(const Tree *tree, const Joint *part, int above, Composite *upper, Derivative *by)
{
    tree_part(tree, part, upper);
    set_gyration(&upper->inertia, upper->velocity, upper->gyration);
    accumulate(upper, &tree->composite[above]);
    for (int k = 0; k < 6; k++)
        differentiate(upper, &tree->composite[0], tree->axes[k], by + k);
}
