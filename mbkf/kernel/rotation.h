/* Rotation vectors, quaternions x y z w, and their derivatives. Matrices of three rows, row by row. */
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

/* Coefficients of the quaternion_of's rotation_series: sin t / t, (1 - cos t) / t^2, (t - sin t) / t^3. */
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

/* product = p q of unit quaternions, of unit length. */
static inline void quaternion_product(const double *p, const double *q, double *product)
{
    const double x = p[3] * q[0] + p[0] * q[3] + p[1] * q[2] - p[2] * q[1];
    const double y = p[3] * q[1] - p[0] * q[2] + p[1] * q[3] + p[2] * q[0];
    const double z = p[3] * q[2] + p[0] * q[1] - p[1] * q[0] + p[2] * q[3];
    const double w = p[3] * q[3] - p[0] * q[0] - p[1] * q[1] - p[2] * q[2];
    const double scale = 0.5 * (3.0 - (x * x + y * y + z * z + w * w)); /* 1 / length, as lengths are nearly 1 */
    product[0] = x * scale, product[1] = y * scale, product[2] = z * scale, product[3] = w * scale;
}

/* Quaternion of a rotation vector. */
static inline void quaternion_of(const double *w, double *q)
{
    const double square = dot3(w, w), t = sqrt(square);
    const double share = t < 1e-3 ? 0.5 - square / 48.0 : sin(0.5 * t) / t;
    for (int i = 0; i < 3; i++)
        q[i] = share * w[i];
    q[3] = cos(0.5 * t);
}

/* Rotation vector of a quaternion, of at most half a turn, and its derivative by a turn in its own axes. */
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
