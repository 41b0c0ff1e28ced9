/* Prediction and update of a covariance P (N x N); see covariance.c. Symmetric matrices have no order. */
#ifndef MBKF_COVARIANCE_H
#define MBKF_COVARIANCE_H

/* Steps of position, velocity and acceleration (mbkf/filters/dynamic/plant.py). */
typedef struct {
    double dt, c1, c2, rho;
} Singer;

/* carried = Phi P Phi' + Q for a state (q, v, a, rest) with Phi_q = [A, B dt, B c2, 0], A and B block diagonal.
 *
 * joints: (n_joints x 2) first dof and number of dofs of each joint; A, B: (nv x nv); noise: (3 x 3) covariance
 * of (q, v, a) for a unit acceleration; sd: (nv) accelerations; work: carry_work(nv, N) numbers. */
void carry(int nv, int N, const double *P, const double *A, const double *B, const int *joints, int n_joints,
           const Singer *singer, const double *noise, const double *sd, double *carried, double *work);
long carry_work(int nv, int N);

/* The same for a state (q, v) with Phi_q = [A, B dt] and velocities that stay.
 *
 * noise: (2 x 2 x nv) diagonals of Q's blocks; work: carry_work(nv, 2 nv) numbers. */
void carry_velocities(int nv, const double *P, const double *A, const double *B, const int *joints, int n_joints,
                      double dt, const double *noise, double *carried, double *work);

/* informed = (P^-1 + L on the first n components + rows' rows)^-1.
 *
 * information: L (n x n); rows: (m x N), row by row; work: inform_work(n, m, N) numbers.
 * Returns 0, or which factorisation failed: the information's (1), or one of the covariance's (2, 3). */
int inform(int N, const double *P, int n, const double *information, int m, const double *rows, double *informed,
           double *work);
long inform_work(int n, int m, int N);

/* step (N) = P (vector (n) on the first components + rows' values), rows (m x N) row by row; total: N numbers. */
void correction(int N, const double *P, int n, const double *vector, int m, const double *rows, const double *values,
                double *step, double *total);

#endif
