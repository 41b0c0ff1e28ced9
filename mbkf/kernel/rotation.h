/* Rotation vectors w, quaternions x y z w, and their derivatives. Matrices are row by row unless it is said. */
#ifndef MBKF_ROTATION_H
#define MBKF_ROTATION_H

#include <math.h>

#include "spatial.h"

static inline void cross_matrix(const double *w, double *W)
{
    W[0] = W[4] = W[8] = 0.0;
    W[1] = -w[2], W[2] = w[1], W[5] = -w[0];
    W[3] = w[2], W[6] = -w[1], W[7] = w[0];
}

static inline void matrix_product(const double *A, const double *B, double *C)
{
    for (int i = 0; i < 9; i += 3)
        for (int j = 0; j < 3; j++)
            C[i + j] = A[i] * B[j] + A[i + 1] * B[3 + j] + A[i + 2] * B[6 + j];
}

/* 1 + a [w]x + b [w]x [w]x. */
static inline void rotation_series(const double *w, double a, double b, double *sum)
{
    const double square = dot3(w, w);
    cross_matrix(w, sum);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            sum[3 * i + j] = a * sum[3 * i + j] + b * w[i] * w[j] + (i == j ? 1.0 - b * square : 0.0);
}

/* sin t / t, (1 - cos t) / t^2 and (t - sin t) / t^3 of t = |w|. */
static inline void coefficients(const double *w, double c[3])
{
    const double square = dot3(w, w), t = sqrt(square), half = sin(0.5 * t);
    if (t < 0.05) {
        c[0] = 1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0));
        c[1] = 0.5 - square / 24.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0));
        c[2] = 1.0 / 6.0 - square / 120.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0));
        return;
    }
    c[0] = sin(t) / t;
    c[1] = 2.0 * half * half / square;
    c[2] = (1.0 - c[0]) / square;
}

/* Rotation matrix of a unit quaternion, column by column. */
static inline void rotation_matrix(const double *q, double *R)
{
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    R[0] = 1.0 - 2.0 * (y * y + z * z), R[1] = 2.0 * (x * y + z * w), R[2] = 2.0 * (x * z - y * w);
    R[3] = 2.0 * (x * y - z * w), R[4] = 1.0 - 2.0 * (x * x + z * z), R[5] = 2.0 * (y * z + x * w);
    R[6] = 2.0 * (x * z + y * w), R[7] = 2.0 * (y * z - x * w), R[8] = 1.0 - 2.0 * (x * x + y * y);
}

/* product = p q of quaternions; product may be p or q. */
static inline void quaternion_product(const double *p, const double *q, double *product)
{
    const double x = p[3] * q[0] + p[0] * q[3] + p[1] * q[2] - p[2] * q[1];
    const double y = p[3] * q[1] - p[0] * q[2] + p[1] * q[3] + p[2] * q[0];
    const double z = p[3] * q[2] + p[0] * q[1] - p[1] * q[0] + p[2] * q[3];
    const double w = p[3] * q[3] - p[0] * q[0] - p[1] * q[1] - p[2] * q[2];
    product[0] = x, product[1] = y, product[2] = z, product[3] = w;
}

/* The same of unit quaternions, of unit length to rounding. */
static inline void unit_product(const double *p, const double *q, double *product)
{
    double raw[4];
    quaternion_product(p, q, raw);
    const double square = raw[0] * raw[0] + raw[1] * raw[1] + raw[2] * raw[2] + raw[3] * raw[3];
    const double scale = 0.5 * (3.0 - square); /* 1 / length, as lengths are nearly 1 */
    for (int i = 0; i < 4; i++)
        product[i] = raw[i] * scale;
}

/* Unit quaternion of a rotation vector. */
static inline void quaternion_of(const double *w, double *q)
{
    const double square = dot3(w, w), t = sqrt(square);
    const double share = t < 1e-3 ? 0.5 - square / 48.0 : sin(0.5 * t) / t;
    for (int i = 0; i < 3; i++)
        q[i] = share * w[i];
    q[3] = cos(0.5 * t);
}

/* Rotation vector of a quaternion, at most pi long, and its derivative by a rotation in its own axes. */
static inline void rotation_vector_of(const double *q, double *w, double *jacobian)
{
    const double n = sqrt(dot3(q, q)), sign = q[3] < 0.0 ? -1.0 : 1.0, t = 2.0 * atan2(n, sign * q[3]);
    const double share = sign * (n < 1e-12 ? 2.0 : t / n), square = t * t;
    for (int i = 0; i < 3; i++)
        w[i] = share * q[i];
    const double along = t < 1e-2 ? 1.0 - square / 12.0 * (1.0 + square / 60.0) : 0.5 * t / tan(0.5 * t);
    rotation_series(w, 0.5, t < 1e-2 ? 1.0 / 12.0 + square / 720.0 : (1.0 - along) / square, jacobian);
}

#endif
