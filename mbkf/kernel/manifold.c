/* Steps on the manifold of configurations, joint by joint, as Pinocchio takes them: q + step = q exp(step). */
#include <string.h>

#include "rotation.h"
#include "tree.h"

/* Translation of exp6(u, w): left Jacobian of w times u. */
static void translation_of(const double *w, const double *u, double *p)
{
    double c[3], across[3], twice[3];
    coefficients(w, c);
    cross(w, u, across);
    cross(w, across, twice);
    for (int i = 0; i < 3; i++)
        p[i] = u[i] + c[1] * across[i] + c[2] * twice[i];
}

/* v rotated by a unit quaternion. */
static void rotated_by(const double *q, const double *v, double *found)
{
    double across[3], twice[3];
    cross(q, v, across);
    cross(q, across, twice);
    for (int i = 0; i < 3; i++)
        found[i] = v[i] + 2.0 * (q[3] * across[i] + twice[i]);
}

static void step_free(const double *q, const double *step, double *stepped)
{
    double own[3], moved[3], turn[4];
    translation_of(step + 3, step, own);
    rotated_by(q + 3, own, moved);
    for (int i = 0; i < 3; i++)
        stepped[i] = q[i] + moved[i];
    quaternion_of(step + 3, turn);
    unit_product(q + 3, turn, stepped + 3);
    if (turn[3] < 0.0) /* of both quaternions of a rotation the one near the old */
        for (int i = 3; i < 7; i++)
            stepped[i] = -stepped[i];
}

void mbkf_integrate(Tree *tree, const double *q, const double *step, double *moved)
{
    for (int i = 1; i < tree->joints; i++) {
        const Joint *joint = &tree->joint[i];
        const double *from = q + joint->at_q, *by = step + joint->at_v;
        double *to = moved + joint->at_q, turn[4];
        if (joint->kind == FREE)
            step_free(from, by, to);
        else if (joint->kind == SPHERICAL) {
            quaternion_of(by, turn);
            unit_product(from, turn, to);
        } else
            to[0] = from[0] + by[0];
    }
}

void mbkf_move_state(int m, int k, Tree *tree, const double *q, const double *v, const double *a, const double *w,
                     const double *extra, const double *step, double *q_after, double *v_after, double *a_after,
                     double *w_after, double *extra_after)
{
    const int nv = tree->nv, sizes[4] = {nv, nv, m, k};
    const double *from[4] = {v, a, w, extra};
    double *to[4] = {v_after, a_after, w_after, extra_after};
    mbkf_integrate(tree, q, step, q_after);
    step += nv;
    for (int part = 0; part < 4; part++)
        for (int i = 0; i < sizes[part]; i++)
            to[part][i] = from[part][i] + *step++;
}

/* A 3 x 3 block of an nv x nv matrix. */
static void put(const double *block, double *matrix, long nv, long row, long column)
{
    for (int i = 0; i < 3; i++)
        memcpy(matrix + (row + i) * nv + column, block + 3 * i, 3 * sizeof *block);
}

/* exp(-[w]x) and the right Jacobian of a rotation vector w. */
static void rotation_derivatives(const double *w, double *by_q, double *by_step)
{
    double c[3];
    coefficients(w, c);
    rotation_series(w, -c[0], c[1], by_q);
    rotation_series(w, -c[1], c[2], by_step);
}

/* Derivative of the translation of exp6(u, w) by w, in its own axes: T. Barfoot, State Estimation for Robotics (2017),
 * eq. 7.86, of (-u, -w). */
static void translation_by_rotation(const double *u, const double *w, double *found)
{
    const double t2 = dot3(w, w), t = sqrt(t2), s = sin(t), c = cos(t), back_u[3] = {-u[0], -u[1], -u[2]};
    const double back_w[3] = {-w[0], -w[1], -w[2]};
    double c1 = 1.0 / 6.0 - t2 / 120.0 * (1.0 - t2 / 42.0 * (1.0 - t2 / 72.0));
    double c2 = 1.0 / 24.0 - t2 / 720.0 * (1.0 - t2 / 56.0 * (1.0 - t2 / 90.0));
    double c3 = 1.0 / 120.0 - t2 / 2520.0 * (1.0 - t2 / 48.0 * (1.0 - t2 * 7.0 / 550.0));
    double U[9], W[9], WU[9], UW[9], WUW[9], WWU[9], UWW[9], WUWW[9], WWUW[9];
    if (t > 0.15) {
        c1 = (t - s) / (t2 * t);
        c2 = (t2 + 2.0 * c - 2.0) / (2.0 * t2 * t2);
        c3 = (2.0 * t - 3.0 * s + t * c) / (2.0 * t2 * t2 * t);
    }
    cross_matrix(back_u, U);
    cross_matrix(back_w, W);
    matrix_product(W, U, WU);
    matrix_product(U, W, UW);
    matrix_product(WU, W, WUW);
    matrix_product(W, WU, WWU);
    matrix_product(UW, W, UWW);
    matrix_product(WUW, W, WUWW);
    matrix_product(W, WUW, WWUW);
    for (int i = 0; i < 9; i++)
        found[i] = 0.5 * U[i] + c1 * (WU[i] + UW[i] + WUW[i]) + c2 * (WWU[i] + UWW[i] - 3.0 * WUW[i]) +
                   c3 * (WUWW[i] + WWUW[i]);
}

static void free_derivatives(const double *step, double *by_q, double *by_step, long nv, long first)
{
    double back[9], right[9], p[3], P[9], block[9];
    const long turn = first + 3;
    rotation_derivatives(step + 3, back, right);
    put(back, by_q, nv, first, first), put(back, by_q, nv, turn, turn);
    put(right, by_step, nv, first, first), put(right, by_step, nv, turn, turn);
    translation_of(step + 3, step, p);
    for (int i = 0; i < 3; i++)
        p[i] = -p[i];
    cross_matrix(p, P);
    matrix_product(back, P, block);
    put(block, by_q, nv, first, turn);
    translation_by_rotation(step, step + 3, block);
    put(block, by_step, nv, first, turn);
}

void mbkf_integration_derivatives(Tree *tree, const double *step, double *by_q, double *by_step)
{
    const long nv = tree->nv;
    memset(by_q, 0, nv * nv * sizeof *by_q);
    memset(by_step, 0, nv * nv * sizeof *by_step);
    for (int i = 1; i < tree->joints; i++) {
        const long first = tree->joint[i].at_v;
        double back[9], right[9];
        if (tree->joint[i].kind == FREE)
            free_derivatives(step + first, by_q, by_step, nv, first);
        else if (tree->joint[i].kind == SPHERICAL) {
            rotation_derivatives(step + first, back, right);
            put(back, by_q, nv, first, first);
            put(right, by_step, nv, first, first);
        } else
            by_q[first * (nv + 1)] = by_step[first * (nv + 1)] = 1.0;
    }
}

/* turn = conjugate of p times q. */
static void rotation_between(const double *p, const double *q, double *turn)
{
    turn[0] = p[3] * q[0] - p[0] * q[3] - p[1] * q[2] + p[2] * q[1];
    turn[1] = p[3] * q[1] - p[1] * q[3] - p[2] * q[0] + p[0] * q[2];
    turn[2] = p[3] * q[2] - p[2] * q[3] - p[0] * q[1] + p[1] * q[0];
    turn[3] = p[3] * q[3] + p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
}

void mbkf_deviation(Tree *tree, const double *start, const double *q, double *angles, double *jacobian)
{
    const long nv = tree->nv;
    memset(angles, 0, nv * sizeof *angles);
    memset(jacobian, 0, nv * nv * sizeof *jacobian);
    for (int i = 1; i < tree->joints; i++) {
        const Joint *joint = &tree->joint[i];
        const long first = joint->at_v;
        double block[9], turn[4];
        if (joint->kind == SPHERICAL) {
            rotation_between(start + joint->at_q, q + joint->at_q, turn);
            rotation_vector_of(turn, angles + first, block);
            put(block, jacobian, nv, first, first);
        } else if (joint->kind == HINGE) {
            angles[first] = q[joint->at_q] - start[joint->at_q];
            jacobian[first * (nv + 1)] = 1.0;
        }
    }
}
