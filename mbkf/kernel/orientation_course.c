/* A sensor's whole recording: the filter's steps and the backward pass of mbkf/imu/orientation_smoothing.py. */
#include <math.h>
#include <string.h>

#include "orientation.h"

static void written(const OrientationState *state, double *row)
{
    memcpy(row, state->quaternion, 4 * sizeof(double));
    memcpy(row + 4, state->bias, 3 * sizeof(double));
    for (int i = 0; i < ERRORS; i++)
        row[7 + i] = state->P[i * (ERRORS + 1)];
}

/* Lower factor of a symmetric positive matrix, in place; 0 where it is none. */
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
    orientation_turned(noise, next, state->P, gain);
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

/* The quaternion of a row turned by a correction, in the world. */
static void corrected(const double *delta, const double *variances, double *row)
{
    const double half = 0.5 * sqrt(delta[0] * delta[0] + delta[1] * delta[1] + delta[2] * delta[2]);
    const double share = 0.5 * (half > 0.0 ? sin(half) / half : 1.0);
    const double a[4] = {share * delta[0], share * delta[1], share * delta[2], cos(half)};
    const double b[4] = {row[0], row[1], row[2], row[3]};
    row[0] = a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1];
    row[1] = a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0];
    row[2] = a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3];
    row[3] = a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2];
    const double length = sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2] + row[3] * row[3]);
    for (int i = 0; i < 4; i++)
        row[i] /= length;
    for (int i = 0; i < 3; i++)
        row[4 + i] += delta[3 + i];
    for (int i = 0; i < ERRORS; i++)
        row[7 + i] = variances[i * (ERRORS + 1)];
}

int orientation_course(const OrientationNoise *noise, const OrientationState *start, int T, long stride,
                       const double *gyro, const double *force, const double *mag, double *course,
                       OrientationState *states, OrientationStep *steps)
{
    OrientationState here = *start, after;
    OrientationStep step;
    double P[SQUARE], delta[ERRORS] = {0.0};
    written(&here, course);
    if (states)
        states[0] = here;
    for (int k = 1; k < T; k++) {
        const long at = k * stride;
        orientation_step(noise, &here, gyro + at, force + at, mag ? mag + at : NULL, &after, &step);
        here = after;
        written(&here, course + (long)k * COURSE_NUMBERS);
        if (states) {
            states[k] = here;
            steps[k] = step;
        }
    }
    if (!states)
        return 1;
    memcpy(P, here.P, sizeof P);
    for (int k = T - 2; k >= 0; k--) {
        if (!smoothed_back(noise, &states[k], &steps[k + 1], P, delta))
            return 0;
        corrected(delta, P, course + (long)k * COURSE_NUMBERS);
    }
    return 1;
}
