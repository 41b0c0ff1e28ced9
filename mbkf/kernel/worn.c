/* Readings of inertial sensors on a tree, and velocities of its points, in axes of the segment that carries them, as
 * mbkf/sensors/body_sensors.py and standing_feet.py have them.
 *
 * Seen from a segment, a dof that moves it changes its velocity by s and its acceleration by A - v x s, with the s and A
 * of a Derivative. A point p of it then changes its velocity by s_u + s_w x p, and its acceleration, centripetal part
 * included, by A_u + A_w x p + 2 s_w x v_p, v_p its velocity; lower u and w are linear and angular parts. */
#include <string.h>

#include "dynamics.h"
#include "rotation.h"

/* Linear part of a motion at a point. */
static void at_point(const double *motion, const double *point, double *linear)
{
    cross(motion + 3, point, linear);
    for (int i = 0; i < 3; i++)
        linear[i] += motion[i];
}

/* Change of a point's acceleration by a dof. */
static void force_change(const double *acceleration, const double *spin, const double *point, const double *speed,
                         double *change)
{
    double coriolis[3];
    at_point(acceleration, point, change);
    cross(spin, speed, coriolis);
    for (int i = 0; i < 3; i++)
        change[i] += 2.0 * coriolis[i];
}

/* Column of three rows: a vector along three axes, weighted. */
static void put(const double axes[3][3], const double *vector, const double *weights, double *column, long stride)
{
    for (int i = 0; i < 3; i++)
        column[i * stride] = weights[i] * dot3(axes[i], vector);
}

/* Derivatives by the motion of one sensor: angular velocity, then specific force, along its axes. */
static void motion_rows(const Tree *tree, int joint, const double *point, const double *speed, const double axes[3][3],
                        const double *weights, double *rows, long N)
{
    static const double still[3] = {0.0, 0.0, 0.0};
    const long nv = tree->nv;
    for (; joint; joint = tree->joint[joint].parent)
        for (int k = tree->joint[joint].at_v; k < tree->joint[joint].at_v + tree->joint[joint].dofs; k++) {
            const Derivative *by = &tree->by[k];
            const double *axis = tree->axes[k];
            double *force = rows + 3 * N, change[3];
            put(axes, by->drag + 3, weights, rows + k, N);
            put(axes, axis + 3, weights, rows + nv + k, N);
            force_change(by->by_q, by->drag + 3, point, speed, change);
            put(axes, change, weights + 3, force + k, N);
            force_change(by->by_v, axis + 3, point, speed, change);
            put(axes, change, weights + 3, force + nv + k, N);
            force_change(axis, still, point, speed, change);
            put(axes, change, weights + 3, force + 2 * nv + k, N);
        }
}

/* Derivative R' [x]x J of a reading R' x, x in the segment's axes, by the turn of its mount. */
static void turn_rows(const double *R, const double *x, const double *left, const double *weights, double *rows, long N)
{
    double crossed[9], moved[9];
    cross_matrix(x, crossed);
    matrix_product(crossed, left, moved);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            rows[i * N + j] = weights[i] * (R[i] * moved[j] + R[3 + i] * moved[3 + j] + R[6 + i] * moved[6 + j]);
}

void mbkf_worn_readings(int S, Tree *tree, const double *q, const double *v, const double *a, const int *joint_ids,
                        const double *places, const double *mounted, const double *weights, const double *biases,
                        const double *turns, const double *measured, int first_bias, int first_turn, int N,
                        double *rows, double *innovation)
{
    memset(rows, 0, sizeof *rows * 6 * S * N);
    tree_force_derivatives(tree, q, v, a);
    for (int s = 0; s < S; s++, rows += 6L * N, innovation += 6, weights += 6, measured += 6) {
        const double *frame = tree->frames + 12 * joint_ids[s];
        const Composite *moving = &tree->composite[joint_ids[s]];
        double c[3], turned[9], left[9], R[9], axes[3][3], point[3], speed[3], whole[6], inside[3];
        coefficients(turns + 3 * s, c);
        rotation_series(turns + 3 * s, c[0], c[1], turned);
        rotation_series(turns + 3 * s, c[1], c[2], left);
        matrix_product(turned, mounted + 9 * s, R);
        for (int i = 0; i < 3; i++) {
            const double column[3] = {R[i], R[3 + i], R[6 + i]};
            rotated(frame, column, axes[i]);
        }
        rotated(frame, places + 3 * s, point);
        for (int i = 0; i < 3; i++)
            point[i] += frame[9 + i];
        at_point(moving->velocity, point, speed);
        memcpy(whole, moving->velocity + 3, 3 * sizeof *whole);
        at_point(moving->acceleration, point, whole + 3);
        cross(moving->velocity + 3, speed, inside);
        for (int i = 0; i < 3; i++)
            whole[3 + i] += inside[i];
        motion_rows(tree, joint_ids[s], point, speed, (const double(*)[3])axes, weights, rows, N);
        for (int part = 0; part < 6; part += 3) {
            double *own = rows + part * N;
            rotated_back(frame, whole + part, inside);
            turn_rows(R, inside, left, weights + part, own + first_turn + 3 * s, N);
            for (int i = 0; i < 3; i++) {
                const double bias = part ? 0.0 : biases[3 * s + i];
                innovation[part + i] = weights[part + i] * (measured[part + i] - dot3(axes[i], whole + part) - bias);
                if (!part)
                    own[i * N + first_bias + 3 * s + i] = weights[i];
            }
        }
    }
}

/* Frames, and velocities of the joints' segments. */
static void place_velocities(Tree *tree, const double *q, const double *v)
{
    tree_place(tree, q);
    memset(tree->composite[0].velocity, 0, sizeof tree->composite[0].velocity);
    for (int i = 1; i < tree->joints; i++) {
        const Joint *joint = &tree->joint[i];
        double *velocity = tree->composite[i].velocity;
        memcpy(velocity, tree->composite[joint->parent].velocity, sizeof tree->composite[i].velocity);
        for (int k = joint->at_v; k < joint->at_v + joint->dofs; k++)
            for (int part = 0; part < 6; part++)
                velocity[part] += tree->axes[k][part] * v[k];
    }
}

/* Column of six rows: a motion at a point, in a frame's axes; and its linear part there. */
static void put_motion(const double *frame, const double *motion, const double *point, double *column, long stride,
                       double *linear)
{
    double inside[6];
    at_point(motion, point, linear);
    rotated_back(frame, linear, inside);
    rotated_back(frame, motion + 3, inside + 3);
    for (int i = 0; i < 6; i++)
        column[i * stride] = inside[i];
}

void mbkf_carried_points(int n, Tree *tree, const double *q, const double *v, const int *joint_ids, const double *points,
                         double *velocities, double *by_motion, double *by_q)
{
    const long nv = tree->nv;
    memset(by_motion, 0, sizeof *by_motion * 12 * n * nv);
    memset(by_q, 0, sizeof *by_q * 3 * n * nv);
    place_velocities(tree, q, v);
    for (int m = 0; m < n; m++, points += 3, velocities += 6, by_motion += 12 * nv, by_q += 3 * nv) {
        const double *frame = tree->frames + 12 * joint_ids[m];
        double drag[6], linear[3];
        put_motion(frame, tree->composite[joint_ids[m]].velocity, points, velocities, 1, linear);
        for (int i = joint_ids[m]; i; i = tree->joint[i].parent)
            for (int k = tree->joint[i].at_v; k < tree->joint[i].at_v + tree->joint[i].dofs; k++) {
                cross_motion(tree->composite[tree->joint[i].parent].velocity, tree->axes[k], drag);
                put_motion(frame, drag, points, by_motion + k, 2 * nv, linear);
                put_motion(frame, tree->axes[k], points, by_motion + nv + k, 2 * nv, linear);
                for (int part = 0; part < 3; part++)
                    by_q[part * nv + k] = linear[part];
            }
    }
}
