/* Inverse dynamics of a tree with its derivatives; see dynamics.c. */
#ifndef MBKF_DYNAMICS_H
#define MBKF_DYNAMICS_H

#include "tree.h"

/* Sums up the forces of composites, without loads; derivatives are not touched. */
void tree_forces(Tree *tree, const double *q, const double *v, const double *a);

/* Sums up composites and their derivatives, without loads. */
void tree_force_derivatives(Tree *tree, const double *q, const double *v, const double *a);

#endif
