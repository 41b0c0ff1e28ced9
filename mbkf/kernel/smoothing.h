/* A smoother's backward pass in its curvature L (N x N); see smoothing.c. Symmetric matrices have no order. */
#ifndef MBKF_SMOOTHING_H
#define MBKF_SMOOTHING_H

/* Phi = [[A, B push_1, B push_2 .., 0], [0, rates, 0], [0, 0, I]] of positions, their `orders` rates and what stays
 * (mbkf/numerics/rate_transition.py). A, B: (nv x nv), zero between joints; joints: (n_joints x 2) first dof and number
 * of dofs; push: (orders); rates: (orders x orders), each a factor on the identity. */
typedef struct {
    int nv, orders, n_joints;
    const double *A, *B, *push, *rates;
    const int *joints;
} Rates;

/* before = Phi' L Phi. work: motion_work(N, nv) numbers. */
void curvature_before_motion(int N, const double *L, const Rates *phi, double *before, double *work);
long motion_work(int N, int nv);

/* The smoothed covariance P - P L P, and L P column by column, which the readings need too. work: (N x N). */
void smoothed_covariance(int N, const double *P, const double *L, double *smoothed, double *LP, double *work);

/* before = L + M - Z M - (Z M)' with M = information on the first n components + rows' rows and
 * Z = L P + M smoothed / 2, which is C' L C + C' M with C = I - P M.
 *
 * rows: (m x N), row by row; work: readings_work(N, m) numbers. */
void curvature_before_readings(int N, const double *L, const double *smoothed, const double *LP, int n,
                               const double *information, int m, const double *rows, double *before, double *work);
long readings_work(int N, int m);

#endif
