/* One step of the orientation filter (OrientationFilter.passage of mbkf/imu/orientation_ekf.py, whose names these are).
 *
 * The error (rotation in the world, gyroscope bias, velocity) passes by Phi = [1, -dt R, 0; 0, 1, 0; -dt [f]x, 0, 1] with
 * the sensor's rotation R and the force f in the world; readings of single components update it one after the other. */
#include "orientation.h"

#include <math.h>
#include <string.h>

#include "rotation.h"

static const double NO_READING = 1e9, TURN = 6.283185307179586;

static int finite3(const double *v)
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

void orientation_turn(const double *v, double *q)
{
    const double half = 0.5 * sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    const double share = 0.5 * (half > 0.0 ? sin(half) / half : 1.0);
    for (int i = 0; i < 3; i++)
        q[i] = share * v[i];
    q[3] = cos(half);
}

/* out += scale [v]x M for three rows of n numbers. */
static void add_cross(const double *v, const double *M, int n, double scale, double *out)
{
    for (int j = 0; j < n; j++) {
        const double a = M[j], b = M[n + j], c = M[2 * n + j];
        out[j] += scale * (v[1] * c - v[2] * b);
        out[n + j] += scale * (v[2] * a - v[0] * c);
        out[2 * n + j] += scale * (v[0] * b - v[1] * a);
    }
}

void orientation_transition(const OrientationNoise *noise, const OrientationStep *step, const double *M, double *out)
{
    memcpy(out, M, sizeof(double) * SQUARE);
    add_cross(step->force, M, ERRORS, -noise->dt_s, out + 6 * ERRORS);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            const double share = -noise->dt_s * step->R[3 * k + i];
            for (int j = 0; j < ERRORS; j++)
                out[i * ERRORS + j] += share * M[(3 + k) * ERRORS + j];
        }
}

static void transposed(const double *M, double *out)
{
    for (int i = 0; i < ERRORS; i++)
        for (int j = 0; j < ERRORS; j++)
            out[j * ERRORS + i] = M[i * ERRORS + j];
}

/* One error component read: covariance and estimate after it (_read_one). */
static void read_one(double *P, double *dx, int index, double innovation, double variance)
{
    double column[ERRORS];
    for (int i = 0; i < ERRORS; i++)
        column[i] = P[i * ERRORS + index];
    const double sum = column[index] + variance;
    for (int i = 0; i < ERRORS; i++) {
        const double gain = column[i] / sum;
        for (int j = 0; j < ERRORS; j++)
            P[i * ERRORS + j] -= gain * column[j];
        dx[i] += gain * innovation;
    }
}

/* The velocity read as zero (_held_back). */
static void held_back(const OrientationNoise *noise, double *P, const double *velocity, double movement, double *dx)
{
    const double wide = noise->still_variance + noise->memory_squared * movement;
    const double spread = (wide < noise->most_variance ? wide : noise->most_variance) * noise->velocity_samples;
    double S[9], inverse[9], PH[3 * ERRORS], K[3 * ERRORS];
    for (int i = 0; i < ERRORS; i++)
        memcpy(PH + 3 * i, P + i * ERRORS + 6, 3 * sizeof(double));
    memcpy(S, PH + 18, sizeof S);
    S[0] += spread, S[4] += spread, S[8] += spread;
    inverse[0] = S[4] * S[8] - S[5] * S[7], inverse[1] = S[2] * S[7] - S[1] * S[8], inverse[2] = S[1] * S[5] - S[2] * S[4];
    inverse[3] = S[5] * S[6] - S[3] * S[8], inverse[4] = S[0] * S[8] - S[2] * S[6], inverse[5] = S[2] * S[3] - S[0] * S[5];
    inverse[6] = S[3] * S[7] - S[4] * S[6], inverse[7] = S[1] * S[6] - S[0] * S[7], inverse[8] = S[0] * S[4] - S[1] * S[3];
    const double size = S[0] * inverse[0] + S[1] * inverse[3] + S[2] * inverse[6];
    for (int i = 0; i < ERRORS; i++)
        for (int j = 0; j < 3; j++)
            K[3 * i + j] = (PH[3 * i] * inverse[j] + PH[3 * i + 1] * inverse[3 + j] + PH[3 * i + 2] * inverse[6 + j]) / size;
    for (int i = 0; i < ERRORS; i++) {
        const double *k = K + 3 * i;
        for (int j = 0; j < ERRORS; j++)
            P[i * ERRORS + j] -= k[0] * PH[3 * j] + k[1] * PH[3 * j + 1] + k[2] * PH[3 * j + 2];
        dx[i] = -(k[0] * velocity[0] + k[1] * velocity[1] + k[2] * velocity[2]);
    }
}

/* The field read as a heading (_headed). */
static void headed(const OrientationNoise *noise, double *P, double *dx, const double *R, const double *mag,
                   const double *usual, double *learnt)
{
    const double none[3] = {0.0, 0.0, 0.0};
    const int seen = finite3(mag), first = isnan(usual[0]) && seen;
    double field[3];
    rotated(R, seen ? mag : none, field);
    memcpy(learnt, usual, 3 * sizeof(double));
    if (!seen) {
        read_one(P, dx, 2, 0.0, NO_READING);
        return;
    }
    const double level = hypot(field[0], field[1]), strength = hypot(level, field[2]), dip = atan2(field[2], level);
    const double known = first ? strength : usual[0], usual_dip = first ? dip : usual[1];
    const double tilted = 0.5 * (P[0] + P[ERRORS + 1]);
    const double other = (strength / known - 1.0) / noise->field_tolerance, off = dip - usual_dip;
    const double disturbance = other * other + off * off / (noise->dip_variance + tilted);
    double steep = fabs(usual_dip) < 1.05 ? 1.05 : fabs(usual_dip);
    steep = tan(steep > 1.4 ? 1.4 : steep);
    const double variance = noise->heading * (1.0 + disturbance) * (1.0 + disturbance) +
                            noise->heading_samples * tilted * steep * steep;
    const double weight = noise->dt_s * (noise->dip_variance / (noise->dip_variance + tilted));
    double lasted = (first || isnan(usual[2]) ? 0.0 : usual[2]) + weight;
    lasted = lasted < noise->field_memory_s ? lasted : noise->field_memory_s;
    const double gain = weight / (lasted > 1e-12 ? lasted : 1e-12);
    learnt[0] = known + gain * (strength - known);
    learnt[1] = usual_dip + gain * off;
    learnt[2] = lasted;
    const double angle = -atan2(field[1], field[0]) - dx[2];
    read_one(P, dx, 2, angle - TURN * nearbyint(angle / TURN), variance);
}

/* A still gyroscope reads its bias (_rested). */
static void rested(const OrientationNoise *noise, double *P, double *dx, const OrientationState *before,
                   const double *gyro, const double *force, double *calm)
{
    int near = 1;
    for (int i = 0; i < 6; i++) {
        const double now = i < 3 ? gyro[i] : force[i - 3], mean = before->calm[i];
        near = near && fabs(now - mean) < (i < 3 ? noise->rest_rate_rad_s : noise->rest_force_m_s2);
        calm[i] = isfinite(now) ? mean + noise->calm * (now - mean) : mean;
    }
    calm[6] = near ? before->calm[6] + noise->dt_s : 0.0;
    const double variance = calm[6] >= noise->rest_after_s ? noise->rest_variance : NO_READING;
    for (int axis = 0; axis < 3; axis++) {
        const double apart = gyro[axis] - before->bias[axis];
        read_one(P, dx, 3 + axis, (isfinite(apart) ? apart : 0.0) - dx[3 + axis], variance);
    }
}

/* Phi P Phi' and the step's noise. */
static void propagate(const OrientationNoise *noise, const OrientationState *before, const double *rate, int turning,
                    OrientationStep *step)
{
    double half[SQUARE], across[SQUARE];
    orientation_transition(noise, step, before->P, half);
    transposed(half, across);
    orientation_transition(noise, step, across, half);
    for (int i = 0; i < ERRORS; i++) /* rounding that is not symmetric would grow */
        for (int j = 0; j < ERRORS; j++)
            step->prior[i * ERRORS + j] = 0.5 * (half[i * ERRORS + j] + half[j * ERRORS + i]);
    const double square = rate[0] * rate[0] + rate[1] * rate[1] + rate[2] * rate[2];
    const double turned_by = noise->dt_s * (turning ? square * noise->gyro_scale_noise + noise->gyro_noise : 1.0);
    for (int i = 0; i < ERRORS; i++)
        step->prior[i * (ERRORS + 1)] += i < 3 ? turned_by : i < 6 ? noise->bias_walk : noise->accelerometer_noise;
}

void orientation_step(const OrientationNoise *noise, const OrientationState *before, const double *gyro,
                      const double *force, const double *mag, OrientationState *after, OrientationStep *step)
{
    const int turning = finite3(gyro), forced = finite3(force);
    const double up[3] = {0.0, 0.0, noise->gravity_m_s2};
    double rate[3], turn[4], q[4], velocity[3], square = 0.0;
    for (int i = 0; i < 3; i++) {
        const double now = turning ? gyro[i] : before->bias[i];
        rate[i] = (noise->integrating ? now : 0.5 * (now + before->last[i])) - before->bias[i];
        after->last[i] = now;
        velocity[i] = noise->dt_s * rate[i];
    }
    orientation_turn(velocity, turn);
    quaternion_product(before->quaternion, turn, q);
    rotation_matrix(q, step->R);
    rotated(step->R, forced ? force : up, step->force);
    if (!forced)
        memcpy(step->force, up, sizeof up);
    for (int i = 0; i < 3; i++) {
        const double pushed = noise->integrating ? step->force[i] : 0.5 * (step->force[i] + before->last[3 + i]);
        velocity[i] = before->velocity[i] + noise->dt_s * (pushed - up[i]);
        after->last[3 + i] = step->force[i];
        square += step->force[i] * step->force[i];
    }
    propagate(noise, before, rate, turning, step);
    const double size = sqrt(square) - noise->gravity_m_s2;
    const double present =
        size * size + noise->turning * (rate[0] * rate[0] + rate[1] * rate[1] + rate[2] * rate[2]);
    after->movement = before->movement + noise->moved * (present - before->movement);
    memcpy(after->P, step->prior, sizeof after->P);
    held_back(noise, after->P, velocity, after->movement, step->dx);
    memcpy(after->field, before->field, sizeof after->field);
    if (mag)
        headed(noise, after->P, step->dx, step->R, mag, before->field, after->field);
    memcpy(after->calm, before->calm, sizeof after->calm);
    if (noise->resting)
        rested(noise, after->P, step->dx, before, gyro, force, after->calm);
    orientation_turn(step->dx, turn);
    quaternion_product(turn, q, after->quaternion);
    const double *p = after->quaternion;
    const double length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3]);
    for (int i = 0; i < 4; i++)
        after->quaternion[i] /= length;
    for (int i = 0; i < 3; i++) {
        after->bias[i] = before->bias[i] + step->dx[3 + i];
        after->velocity[i] = velocity[i] + step->dx[6 + i];
    }
}
