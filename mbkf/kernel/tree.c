/* Places and axes of a tree's joints, from the root to the leaves. */
#include "tree.h"

#include "call.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "rotation.h"

/* A joint from its row of each array; 0 where it exceeds the tree's sizes. */
static int is_filled(Tree *tree, int i, int parent, int kind, int first_q, int first_v)
{
    static const int dofs[] = {6, 3, 1}, components[] = {7, 4, 1};
    Joint *joint = &tree->joint[i];
    joint->parent = parent, joint->kind = kind, joint->at_q = first_q, joint->at_v = first_v, joint->dofs = dofs[kind];
    return parent < i && first_q + components[kind] <= tree->nq && first_v + dofs[kind] <= tree->nv;
}

Tree *mbkf_make_tree(int joints, int nq, int nv, const int *parent, const int *kind, const int *first_q,
                     const int *first_v, const double *axis, const double *rotation, const double *origin,
                     const double *mass, const double *lever, const double *inertia, const double *gravity)
{
    Tree *tree = calloc(1, sizeof *tree);
    if (!tree) {
        refuse(out_of_memory);
        return NULL;
    }
    tree->joints = joints, tree->nq = nq, tree->nv = nv;
    tree->joint = calloc(joints, sizeof *tree->joint);
    tree->frames = calloc(joints, 12 * sizeof *tree->frames);
    tree->axes = calloc(nv, sizeof *tree->axes);
    tree->motion = calloc(nv, sizeof *tree->motion);
    tree->composite = calloc(joints, sizeof *tree->composite);
    tree->by = calloc(nv, sizeof *tree->by);
    int sound = tree->joint && tree->frames && tree->axes && tree->motion && tree->composite && tree->by;
    if (!sound)
        refuse(out_of_memory);
    for (int i = 1; sound && i < joints; i++) {
        Joint *joint = &tree->joint[i];
        memcpy(joint->axis, axis + 3 * i, sizeof joint->axis);
        for (int row = 0; row < 3; row++)
            for (int column = 0; column < 3; column++)
                joint->rotation[3 * column + row] = rotation[9 * i + 3 * row + column];
        memcpy(joint->origin, origin + 3 * i, sizeof joint->origin);
        joint->mass = mass[i];
        memcpy(joint->lever, lever + 3 * i, sizeof joint->lever);
        memcpy(joint->inertia, inertia + 9 * i, sizeof joint->inertia);
        if (!is_filled(tree, i, parent[i], kind[i], first_q[i], first_v[i]) || kind[1] != FREE) {
            refuse("the joints do not make a tree with a free root");
            sound = 0;
        }
    }
    if (!sound) {
        mbkf_free_tree(tree);
        return NULL;
    }
    memcpy(tree->gravity, gravity, sizeof tree->gravity);
    tree->frames[0] = tree->frames[4] = tree->frames[8] = 1.0;
    return tree;
}

void mbkf_free_tree(Tree *tree)
{
    free(tree->joint);
    free(tree->frames);
    free(tree->axes);
    free(tree->motion);
    free(tree->composite);
    free(tree->by);
    free(tree);
}

/* Rotation by an angle about a unit axis. */
static void rotation_of_hinge(const double *n, double angle, double *R)
{
    const double c = cos(angle), s = sin(angle), rest = 1.0 - c;
    R[0] = c + rest * n[0] * n[0], R[1] = rest * n[0] * n[1] + s * n[2], R[2] = rest * n[0] * n[2] - s * n[1];
    R[3] = rest * n[0] * n[1] - s * n[2], R[4] = c + rest * n[1] * n[1], R[5] = rest * n[1] * n[2] + s * n[0];
    R[6] = rest * n[0] * n[2] + s * n[1], R[7] = rest * n[1] * n[2] - s * n[0], R[8] = c + rest * n[2] * n[2];
}

static void place(const Joint *joint, const double *q, const double *parent, double *frame)
{
    double own[9], before[9], at[3];
    memcpy(at, joint->origin, sizeof at);
    if (joint->kind == FREE) {
        double moved[3];
        rotated(joint->rotation, q, moved);
        for (int i = 0; i < 3; i++)
            at[i] += moved[i];
        rotation_matrix(q + 3, own);
    } else if (joint->kind == SPHERICAL)
        rotation_matrix(q, own);
    else
        rotation_of_hinge(joint->axis, q[0], own);
    for (int i = 0; i < 9; i += 3)
        rotated(parent, joint->rotation + i, before + i);
    for (int i = 0; i < 9; i += 3)
        rotated(before, own + i, frame + i);
    rotated(parent, at, frame + 9);
    for (int i = 0; i < 3; i++)
        frame[9 + i] += parent[9 + i];
}

/* Velocity by a rotation about an axis through a frame's origin. */
static void turning(const double *frame, const double *axis, double *column)
{
    memcpy(column + 3, axis, 3 * sizeof *column);
    cross(frame + 9, axis, column);
}

static void move(const Joint *joint, const double *frame, double (*columns)[6])
{
    if (joint->kind == HINGE) {
        double axis[3];
        rotated(frame, joint->axis, axis);
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

void tree_place(Tree *tree, const double *q)
{
    for (int i = 1; i < tree->joints; i++) {
        const Joint *joint = &tree->joint[i];
        double *frame = tree->frames + 12 * i;
        place(joint, q + joint->at_q, tree->frames + 12 * joint->parent, frame);
        move(joint, frame, tree->axes + joint->at_v);
    }
}

void mbkf_frames_and_jacobian(Tree *tree, const double *q, double *frames, double *jacobian)
{
    tree_place(tree, q);
    memcpy(frames, tree->frames, sizeof(double) * 12 * tree->joints);
    memcpy(jacobian, tree->axes, sizeof *tree->axes * tree->nv);
}

void mbkf_frames_and_jacobians(int frames_count, Tree *tree, const double *q, double *frames, double *jacobians)
{
    for (int t = 0; t < frames_count; t++) {
        mbkf_frames_and_jacobian(tree, q, frames, jacobians);
        q += tree->nq, frames += 12 * tree->joints, jacobians += 6 * tree->nv;
    }
}

/* Height of a point p on a joint: its velocity (v + w x p)_z by each dof below the joint. */
void mbkf_height_jacobian(int n, Tree *tree, const double *q, const int *joint_ids, double *heights)
{
    tree_place(tree, q);
    memset(heights, 0, sizeof *heights * n * tree->nv);
    for (int row = 0; row < n; row++, heights += tree->nv) {
        const double *p = tree->frames + 12 * joint_ids[row] + 9;
        for (int i = joint_ids[row]; i; i = tree->joint[i].parent)
            for (int k = tree->joint[i].at_v; k < tree->joint[i].at_v + tree->joint[i].dofs; k++)
                heights[k] = tree->axes[k][3] * p[1] - tree->axes[k][4] * p[0] + tree->axes[k][2];
    }
}
