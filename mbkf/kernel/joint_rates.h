/* Variances of the angles and rates of joints with three angles; see joint_rates.c. */
#ifndef MBKF_JOINT_RATES_H
#define MBKF_JOINT_RATES_H

/* How joints with three angles are read (mbkf/model/clinical.py). */
typedef struct {
    int count;
    const int *places;   /* (count x 4) first number of the quaternion in q, and the axes i, j, k */
    const double *signs; /* (count x 4) parity of (i, j, k), and the angles' signs */
    int root;            /* first number of the root's quaternion in q */
    const double *axes;  /* (3 x 3), row by row: the root's position from the world's axes to those it is told in */
} JointReading;

/* variance: (sets x count + 1 x 3) of every joint's three coordinates, last the root's position, for covariances
 * (sets x count + 1 x 3 x 3) of its dofs. */
void joint_variances(const JointReading *r, const double *q, int sets, const double *covariance, double *variance);

#endif
