/* Places and axes of a tree's joints, from the root to the leaves. */
#include "tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

Tree *tree_made(int joints, int nq, int nv)
{
    Tree *tree = calloc(1, sizeof *tree);
    if (!tree)
        return NULL;
    tree->joints = joints, tree->nq = nq, tree->nv = nv;
    tree->joint = calloc(joints, sizeof *tree->joint);
    tree->frames = calloc(joints, 12 * sizeof *tree->frames);
    tree->axes = calloc(nv, sizeof *tree->axes);
    tree->motion = calloc(nv, sizeof *tree->motion);
    tree->carried = calloc(joints, sizeof *tree->carried);
    tree->by = calloc(nv, sizeof *tree->by);
    if (!tree->joint || !tree->frames || !tree->axes || !tree->motion || !tree->carried || !tree->by) {
        tree_freed(tree);
        return NULL;
    }
    tree->frames[0] = tree->frames[4] = tree->frames[8] = 1.0;
    return tree;
}

void tree_freed(Tree *tree)
{
    free(tree->joint);
    free(tree->frames);
    free(tree->axes);
    free(tree->motion);
    free(tree->carried);
    free(tree->by);
    free(tree);
}

/* Rotation of a unit quaternion x y z w. */
static void turn_of_quaternion(const double *q, double *R)
{
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    R[0] = 1.0 - 2.0 * (y * y + z * z), R[1] = 2.0 * (x * y + z * w), R[2] = 2.0 * (x * z - y * w);
    R[3] = 2.0 * (x * y - z * w), R[4] = 1.0 - 2.0 * (x * x + z * z), R[5] = 2.0 * (y * z + x * w);
    R[6] = 2.0 * (x * z + y * w), R[7] = 2.0 * (y * z - x * w), R[8] = 1.0 - 2.0 * (x * x + y * y);
}

/* Rotation by an angle about a unit axis. */
static void turn_of_hinge(const double *n, double angle, double *R)
{
    const double c = cos(angle), s = sin(angle), rest = 1.0 - c;
    R[0] = c + rest * n[0] * n[0], R[1] = rest * n[0] * n[1] + s * n[2], R[2] = rest * n[0] * n[2] - s * n[1];
    R[3] = rest * n[0] * n[1] - s * n[2], R[4] = c + rest * n[1] * n[1], R[5] = rest * n[1] * n[2] + s * n[0];
    R[6] = rest * n[0] * n[2] + s * n[1], R[7] = rest * n[1] * n[2] - s * n[0], R[8] = c + rest * n[2] * n[2];
}

static void place(const Joint *joint, const double *q, const double *parent, double *frame)
{
    double own[9], before[9], at[3];
    memcpy(at, joint->shift, sizeof at);
    if (joint->kind == FREE) {
        double moved[3];
        turned(joint->turn, q, moved);
        for (int i = 0; i < 3; i++)
            at[i] += moved[i];
        turn_of_quaternion(q + 3, own);
    } else if (joint->kind == SPHERICAL)
        turn_of_quaternion(q, own);
    else
        turn_of_hinge(joint->axis, q[0], own);
    for (int i = 0; i < 9; i += 3)
        turned(parent, joint->turn + i, before + i);
    for (int i = 0; i < 9; i += 3)
        turned(before, own + i, frame + i);
    turned(parent, at, frame + 9);
    for (int i = 0; i < 3; i++)
        frame[9 + i] += parent[9 + i];
}

/* Velocity by a turn about an axis through a frame's origin. */
static void turning(const double *frame, const double *axis, double *column)
{
    memcpy(column + 3, axis, 3 * sizeof *column);
    cross(frame + 9, axis, column);
}

static void move(const Joint *joint, const double *frame, double (*columns)[6])
{
    if (joint->kind == HINGE) {
        double axis[3];
        turned(frame, joint->axis, axis);
        turning(frame, axis, columns[0]);
        return;
    }
    if (joint->kind == FREE)
        for (int i = 0; i < 3; i++, columns++) {
            memcpy(columns[0], frame + 3 * i, 3 * sizeof *frame);
            memset(columns[0] + 3, 0, 3 * sizeof *frame);
        }
    for (int i = 0; i < 3; i++)
        turning(frame, frame + 3 * i, columns[i]);
}

void tree_placed(Tree *tree, const double *q)
{
    for (int i = 1; i < tree->joints; i++) {
        const Joint *joint = &tree->joint[i];
        double *frame = tree->frames + 12 * i;
        place(joint, q + joint->at_q, tree->frames + 12 * joint->parent, frame);
        move(joint, frame, tree->axes + joint->at_v);
    }
}

void tree_rise(const Tree *tree, int joint, double *rise)
{
    const double x = tree->frames[12 * joint + 9], y = tree->frames[12 * joint + 10];
    memset(rise, 0, sizeof *rise * tree->nv);
    for (int i = joint; i; i = tree->joint[i].parent)
        for (int k = tree->joint[i].at_v; k < tree->joint[i].at_v + tree->joint[i].dofs; k++)
            rise[k] = tree->axes[k][3] * y - tree->axes[k][4] * x + tree->axes[k][2];
}
