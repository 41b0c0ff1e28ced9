/* Steps on the manifold of a tree's configurations, with derivatives; see manifold.c. Matrices row by row. */
#ifndef MBKF_MANIFOLD_H
#define MBKF_MANIFOLD_H

#include "tree.h"

/* stepped (nq) = q + step (nv) on the manifold. */
void tree_stepped(const Tree *tree, const double *q, const double *step, double *stepped);

/* Derivatives (nv x nv) of that by q and by the step, both in tangent spaces. */
void tree_step_derivatives(const Tree *tree, const double *step, double *by_q, double *by_step);

/* Turn (nv) of every joint from the neutral configuration as a rotation vector, and its derivative (nv x nv); zero
 * for free joints. */
void tree_deviation(const Tree *tree, const double *start, const double *q, double *deviation, double *jacobian);

#endif
