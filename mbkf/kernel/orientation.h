/* One step of a sensor's orientation filter (orientation.c), and its course over a recording (orientation_course.c):
 * mbkf/imu/orientation_ekf.py and mbkf/imu/orientation_smoothing.py, sample by sample in the same arithmetic. */
#ifndef MBKF_ORIENTATION_H
#define MBKF_ORIENTATION_H

#include "declared.h"

enum { ERRORS = 9, SQUARE = ERRORS * ERRORS };

/* The fields of OrientationState in mbkf/imu/orientation_ekf.py, of one sensor. */
typedef struct {
    double quaternion[4], bias[3], velocity[3], P[SQUARE], movement, field[3], calm[7], last[6];
} OrientationState;

/* A step's part that a smoother needs: covariance before readings, rotation of the sensor (3 x 3, column by column) and
 * force in the world, which make the transition, and the correction. */
typedef struct {
    double prior[SQUARE], R[9], force[3], dx[ERRORS];
} OrientationStep;

/* One sample later; `mag` is NULL without a magnetometer. */
void orientation_step(const OrientationNoise *noise, const OrientationState *before, const double *gyro,
                      const double *force, const double *mag, OrientationState *after, OrientationStep *step);

/* Quaternion of a rotation vector. */
void orientation_turn(const double *v, double *q);

/* out = Phi M with the error's transition Phi of a step. */
void orientation_transition(const OrientationNoise *noise, const OrientationStep *step, const double *M, double *out);

#endif
