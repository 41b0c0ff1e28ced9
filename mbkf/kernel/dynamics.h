/* Inverse dynamics of a tree with its derivatives; see dynamics.c. */
#ifndef MBKF_DYNAMICS_H
#define MBKF_DYNAMICS_H

#include "tree.h"

/* Inertia of a joint's segment about the origin of the axes in which its frame R (axes and origin) stands. */
void segment_inertia(const Joint *joint, const double *R, Inertia *inertia);

/* Sums up the forces of composites, without loads; derivatives are not touched. */
void tree_forces(Tree *tree, const double *q, const double *v, const double *a);

/* Sums up composites and their derivatives, without loads. */
void tree_force_derivatives(Tree *tree, const double *q, const double *v, const double *a);

#endif
