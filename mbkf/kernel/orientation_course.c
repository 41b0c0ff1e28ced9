/* A sensor's whole recording: the filter's steps and the backward pass of mbkf/imu/orientation_smoothing.py. */
#include "orientation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "call.h"
#include "rotation.h"

/* A sample's place in the results. */
typedef struct {
    double *quaternion, *bias, *variances;
} Row;

static void write_row(const OrientationState *state, Row row)
{
    memcpy(row.quaternion, state->quaternion, sizeof state->quaternion);
    memcpy(row.bias, state->bias, sizeof state->bias);
    for (int i = 0; i < ERRORS; i++)
        row.variances[i] = state->P[i * (ERRORS + 1)];
}

/* Lower factor of a symmetric positive matrix, in place; 0 where it is not positive. */
static int factored(double *A)
{
    for (int j = 0; j < ERRORS; j++) {
        for (int k = 0; k < j; k++)
            for (int i = j; i < ERRORS; i++)
                A[i * ERRORS + j] -= A[i * ERRORS + k] * A[j * ERRORS + k];
        if (!(A[j * (ERRORS + 1)] > 0.0))
            return 0;
        const double root = sqrt(A[j * (ERRORS + 1)]);
        for (int i = j; i < ERRORS; i++)
            A[i * ERRORS + j] /= root;
    }
    return 1;
}

/* X = A^-1 B by the factor of A, column by column of B. */
static void solved(const double *L, double *B)
{
    for (int i = 0; i < ERRORS; i++) {
        for (int k = 0; k < i; k++)
            for (int j = 0; j < ERRORS; j++)
                B[i * ERRORS + j] -= L[i * ERRORS + k] * B[k * ERRORS + j];
        for (int j = 0; j < ERRORS; j++)
            B[i * ERRORS + j] /= L[i * (ERRORS + 1)];
    }
    for (int i = ERRORS - 1; i >= 0; i--) {
        for (int k = i + 1; k < ERRORS; k++)
            for (int j = 0; j < ERRORS; j++)
                B[i * ERRORS + j] -= L[k * ERRORS + i] * B[k * ERRORS + j];
        for (int j = 0; j < ERRORS; j++)
            B[i * ERRORS + j] /= L[i * (ERRORS + 1)];
    }
}

/* Correction and covariance of a sample from those of the next: delta = C (d + delta'), P + C (P' - prior) C'. */
static int smoothed_back(const OrientationNoise *noise, const OrientationState *state, const OrientationStep *next,
                         double *P, double *delta)
{
    double gain[SQUARE], factor[SQUARE], sum[ERRORS], middle[SQUARE]; /* gain: C' = prior^-1 Phi P */
    memcpy(factor, next->prior, sizeof factor);
    orientation_transition(noise, next, state->P, gain);
    if (!factored(factor))
        return 0;
    solved(factor, gain);
    for (int i = 0; i < ERRORS; i++)
        sum[i] = next->dx[i] + delta[i];
    for (int i = 0; i < SQUARE; i++)
        factor[i] = P[i] - next->prior[i];
    memset(middle, 0, sizeof middle);
    for (int i = 0; i < ERRORS; i++) {
        delta[i] = 0.0;
        for (int k = 0; k < ERRORS; k++) {
            const double c = gain[k * ERRORS + i];
            delta[i] += c * sum[k];
            for (int j = 0; j < ERRORS; j++)
                middle[i * ERRORS + j] += c * factor[k * ERRORS + j];
        }
    }
    memcpy(P, state->P, sizeof state->P);
    for (int i = 0; i < ERRORS; i++)
        for (int k = 0; k < ERRORS; k++) {
            const double m = middle[i * ERRORS + k];
            for (int j = 0; j < ERRORS; j++)
                P[i * ERRORS + j] += m * gain[k * ERRORS + j];
        }
    for (int i = 0; i < ERRORS; i++)
        for (int j = 0; j < i; j++)
            P[i * ERRORS + j] = P[j * ERRORS + i] = 0.5 * (P[i * ERRORS + j] + P[j * ERRORS + i]);
    return 1;
}

/* A row's quaternion rotated by a correction in the world, and its bias and variances. */
static void correct_row(const double *delta, const double *P, Row row)
{
    double turn[4], *q = row.quaternion;
    orientation_turn(delta, turn);
    quaternion_product(turn, q, q);
    const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int i = 0; i < 4; i++)
        q[i] /= length;
    for (int i = 0; i < 3; i++)
        row.bias[i] += delta[3 + i];
    for (int i = 0; i < ERRORS; i++)
        row.variances[i] = P[i * (ERRORS + 1)];
}

/* Readings and results of one sensor among N. */
typedef struct {
    int N, T;
    const double *gyro, *force, *mag;
    double *quaternions, *biases, *variances;
} Course;

static Row row_of(const Course *course, int k)
{
    const long at = (long)k * course->N;
    return (Row){course->quaternions + 4 * at, course->biases + 3 * at, course->variances + ERRORS * at};
}

/* One sensor, smoothed unless states (T) and steps (T) are NULL; 0 where a covariance is not positive. */
static int follow(const OrientationNoise *noise, const OrientationState *start, const Course *course,
                  OrientationState *states, OrientationStep *steps)
{
    OrientationState here = *start, after;
    OrientationStep step;
    double P[SQUARE], delta[ERRORS] = {0.0};
    write_row(&here, row_of(course, 0));
    if (states)
        states[0] = here;
    for (int k = 1; k < course->T; k++) {
        const long at = 3L * k * course->N;
        orientation_step(noise, &here, course->gyro + at, course->force + at, course->mag ? course->mag + at : NULL,
                         &after, &step);
        here = after;
        write_row(&here, row_of(course, k));
        if (states) {
            states[k] = here;
            steps[k] = step;
        }
    }
    if (!states)
        return 1;
    memcpy(P, here.P, sizeof P);
    for (int k = course->T - 2; k >= 0; k--) {
        if (!smoothed_back(noise, &states[k], &steps[k + 1], P, delta))
            return 0;
        correct_row(delta, P, row_of(course, k));
    }
    return 1;
}

int mbkf_orientation_course(int N, int T, const OrientationNoise *noise, const double *quaternion,
                            const double *gyro_bias, const double *velocity, const double *P, const double *movement,
                            const double *field, const double *calm, const double *last, const double *gyro,
                            const double *specific_force, const double *magnetic_field, int smooth,
                            double *quaternions, double *biases, double *variances)
{
    OrientationState *states = smooth ? malloc(sizeof *states * T) : NULL;
    OrientationStep *steps = smooth ? malloc(sizeof *steps * T) : NULL;
    int sound = !smooth || (states && steps);
    if (!sound)
        refuse(out_of_memory);
    for (int n = 0; n < N && sound; n++) {
        OrientationState start = {.movement = movement[n]};
        const Course course = {N, T, gyro + 3 * n, specific_force + 3 * n, magnetic_field ? magnetic_field + 3 * n : NULL,
                               quaternions + 4 * n, biases + 3 * n, variances + ERRORS * n};
        memcpy(start.quaternion, quaternion + 4 * n, sizeof start.quaternion);
        memcpy(start.bias, gyro_bias + 3 * n, sizeof start.bias);
        memcpy(start.velocity, velocity + 3 * n, sizeof start.velocity);
        memcpy(start.P, P + SQUARE * n, sizeof start.P);
        memcpy(start.field, field + 3 * n, sizeof start.field);
        memcpy(start.calm, calm + 7 * n, sizeof start.calm);
        memcpy(start.last, last + 6 * n, sizeof start.last);
        sound = follow(noise, &start, &course, states, steps);
    }
    free(states);
    free(steps);
    return sound;
}
