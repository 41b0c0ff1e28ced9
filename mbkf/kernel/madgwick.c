/* A sensor's whole recording by Madgwick's filter: mbkf/imu/madgwick.py, sample by sample in the same arithmetic. */
#include <math.h>
#include <string.h>

#include "declared.h"

static const double tiny = 1e-30;

/* Unit vector of a reading, zero where it is missing or zero; 1 where there is one, else 0. */
static int direction(const double *v, double *unit)
{
    const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    const int there = isfinite(length) && length > 0.0;
    for (int i = 0; i < 3; i++)
        unit[i] = there ? v[i] / length : 0.0;
    return there;
}

/* J' f of gravity's three rows, s (4), for q = (w, x, y, z). */
static void gravity_step(const double *q, const double *a, double *s)
{
    const double f1 = 2.0 * (q[1] * q[3] - q[0] * q[2]) - a[0];
    const double f2 = 2.0 * (q[0] * q[1] + q[2] * q[3]) - a[1];
    const double f3 = 1.0 - 2.0 * (q[1] * q[1] + q[2] * q[2]) - a[2];
    s[0] = 2.0 * (q[1] * f2 - q[2] * f1);
    s[1] = 2.0 * (q[3] * f1 + q[0] * f2) - 4.0 * q[1] * f3;
    s[2] = 2.0 * (q[3] * f2 - q[0] * f1) - 4.0 * q[2] * f3;
    s[3] = 2.0 * (q[1] * f1 + q[2] * f2);
}

/* J' f of the field's three rows, added to s. */
static void add_field_step(const double *q, const double *m, double *s)
{
    const double xx = 1.0 - 2.0 * (q[2] * q[2] + q[3] * q[3]), yy = 1.0 - 2.0 * (q[1] * q[1] + q[3] * q[3]);
    const double zz = 1.0 - 2.0 * (q[1] * q[1] + q[2] * q[2]);
    const double xy = 2.0 * (q[1] * q[2] - q[0] * q[3]), xz = 2.0 * (q[1] * q[3] + q[0] * q[2]);
    const double yx = 2.0 * (q[1] * q[2] + q[0] * q[3]), yz = 2.0 * (q[2] * q[3] - q[0] * q[1]);
    const double zx = 2.0 * (q[1] * q[3] - q[0] * q[2]), zy = 2.0 * (q[2] * q[3] + q[0] * q[1]);
    const double hx = xx * m[0] + xy * m[1] + xz * m[2], hy = yx * m[0] + yy * m[1] + yz * m[2];
    double bx = sqrt(hx * hx + hy * hy), bz = zx * m[0] + zy * m[1] + zz * m[2];
    const double f4 = bx * xx + bz * zx - m[0], f5 = bx * xy + bz * zy - m[1], f6 = bx * xz + bz * zz - m[2];
    bx *= 2.0;
    bz *= 2.0;
    s[0] += -bz * q[2] * f4 + (bz * q[1] - bx * q[3]) * f5 + bx * q[2] * f6;
    s[1] += bz * q[3] * f4 + (bx * q[2] + bz * q[0]) * f5 + (bx * q[3] - 2.0 * bz * q[1]) * f6;
    s[2] += -(2.0 * bx * q[2] + bz * q[0]) * f4 + (bx * q[1] + bz * q[3]) * f5 + (bx * q[0] - 2.0 * bz * q[2]) * f6;
    s[3] += (bz * q[1] - 2.0 * bx * q[3]) * f4 + (bz * q[2] - bx * q[0]) * f5 + bx * q[1] * f6;
}

/* The orientation q = (w, x, y, z) and the bias, one sample later. */
static void advance(double dt, double beta, double zeta, const double *gyro, const double *force, const double *mag,
                    double *q, double *bias)
{
    double a[3], m[3], s[4], g[3], p[4];
    const int gravity = direction(force, a);
    gravity_step(q, a, s);
    if (mag) {
        direction(mag, m);
        add_field_step(q, m, s);
    }
    double scale = 1.0 / sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + s[3] * s[3] + tiny);
    for (int i = 0; i < 4; i++)
        s[i] *= scale;
    beta = gravity ? beta : 0.0;
    for (int i = 0; i < 3; i++)
        g[i] = isnan(gyro[i]) ? 0.0 : gyro[i];
    if (zeta != 0.0) {
        const double rate = beta > 0.0 ? 2.0 * zeta * dt : 0.0;
        bias[0] += rate * (q[0] * s[1] - q[1] * s[0] - q[2] * s[3] + q[3] * s[2]);
        bias[1] += rate * (q[0] * s[2] + q[1] * s[3] - q[2] * s[0] - q[3] * s[1]);
        bias[2] += rate * (q[0] * s[3] - q[1] * s[2] + q[2] * s[1] - q[3] * s[0]);
        for (int i = 0; i < 3; i++)
            g[i] -= bias[i];
    }
    p[0] = q[0] + dt * (0.5 * (-q[1] * g[0] - q[2] * g[1] - q[3] * g[2]) - beta * s[0]);
    p[1] = q[1] + dt * (0.5 * (q[0] * g[0] + q[2] * g[2] - q[3] * g[1]) - beta * s[1]);
    p[2] = q[2] + dt * (0.5 * (q[0] * g[1] - q[1] * g[2] + q[3] * g[0]) - beta * s[2]);
    p[3] = q[3] + dt * (0.5 * (q[0] * g[2] + q[1] * g[1] - q[2] * g[0]) - beta * s[3]);
    scale = 1.0 / sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3]);
    for (int i = 0; i < 4; i++)
        q[i] = scale * p[i];
}

void mbkf_madgwick_course(int N, int T, const double *quaternion, const double *gyro, const double *specific_force,
                          const double *magnetic_field, double dt_s, double beta, double zeta, double *quaternions,
                          double *biases)
{
    for (int n = 0; n < N; n++) {
        const double *first = quaternion + 4 * n; /* x, y, z, w */
        double q[4] = {first[3], first[0], first[1], first[2]}, bias[3] = {0.0};
        for (int k = 0; k < T; k++) {
            const long at = (long)k * N + n;
            if (k > 0)
                advance(dt_s, beta, zeta, gyro + 3 * at, specific_force + 3 * at,
                        magnetic_field ? magnetic_field + 3 * at : NULL, q, bias);
            const double row[4] = {q[1], q[2], q[3], q[0]};
            memcpy(quaternions + 4 * at, row, sizeof row);
            memcpy(biases + 3 * at, bias, sizeof bias);
        }
    }
}
