/* A sensor's orientation over a recording, filtered and smoothed: mbkf/imu/orientation_ekf.py and
 * mbkf/imu/orientation_smoothing.py, sample by sample in the same arithmetic. */
#ifndef MBKF_ORIENTATION_H
#define MBKF_ORIENTATION_H

enum { ERRORS = 9, SQUARE = ERRORS * ERRORS };

/* Noise per step; the order is that of mbkf/imu/orientation_course.py. */
typedef struct {
    double dt, gravity;
    double gyro_noise, gyro_scale_noise, bias_walk, accelerometer_noise; /* variances per second, and per step */
    double moved, turning, still_variance, memory_squared, most_variance, velocity_samples;
    double heading, heading_samples, field_tolerance, dip_variance, field_memory;
    double calm, rest_rate, rest_force, rest_after, rest_variance;
    double resting, integrating; /* 0 or 1 */
} OrientationNoise;
enum { NOISE_NUMBERS = sizeof(OrientationNoise) / sizeof(double) };

/* The fields of OrientationState, one sensor. */
typedef struct {
    double quaternion[4], bias[3], velocity[3], P[SQUARE], movement, field[3], calm[7], last[6];
} OrientationState;
enum { STATE_NUMBERS = sizeof(OrientationState) / sizeof(double) };

/* What a step does beside the new state: covariance before readings, turn of the error by the bias (3 x 3), force in the
 * world, which turns the error into velocity, and the correction. */
typedef struct {
    double prior[SQUARE], R[9], force[3], dx[ERRORS];
} OrientationStep;

/* One sample later; `mag` is NULL without a magnetometer. */
void orientation_step(const OrientationNoise *noise, const OrientationState *before, const double *gyro,
                      const double *force, const double *mag, OrientationState *after, OrientationStep *step);

/* The error's transition of a step from the left: out = Phi M. */
void orientation_turned(const OrientationNoise *noise, const OrientationStep *step, const double *M, double *out);

/* A row of a course: quaternion (4), bias (3), variances (9). */
enum { COURSE_NUMBERS = 7 + ERRORS };

/* The course (T x COURSE_NUMBERS) of a sensor; smoothed, unless `states` is NULL. Readings are (T x 3), `stride` numbers
 * from one sample to the next; states: T of them, steps: T of them, as working memory. 0 where a matrix is none. */
int orientation_course(const OrientationNoise *noise, const OrientationState *start, int T, long stride,
                       const double *gyro, const double *force, const double *mag, double *course,
                       OrientationState *states, OrientationStep *steps);

#endif
