/* What the joints' rotations say about a configuration; see posture.c. */
#ifndef MBKF_POSTURE_H
#define MBKF_POSTURE_H

#include "tree.h"

/* matrix (nv x nv) = J' W^2 J and vector (nv) = -J' W^2 residual, J block diagonal over joints (tree_deviation),
 * W the weights (nv). */
void tree_posture(const Tree *tree, const double *residual, const double *jacobian, const double *weights,
                  double *matrix, double *vector);

/* beyond (nv): how far each turn lies outside of its limits, and how many do. A turn that is within them the other
 * way round, beyond half a turn, is within them. */
int tree_beyond(const Tree *tree, const double *deviation, const double *lower, const double *upper, double *beyond);

#endif
