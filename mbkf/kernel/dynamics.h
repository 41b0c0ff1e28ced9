/* Inverse dynamics of a tree with its derivatives; see dynamics.c. */
#ifndef MBKF_DYNAMICS_H
#define MBKF_DYNAMICS_H

#include "tree.h"

/* Fills the forces of carried, of all that a joint carries and without load; not by. */
void tree_loaded(Tree *tree, const double *q, const double *v, const double *a);

/* Fills carried and by, forces without load. */
void tree_differentiated(Tree *tree, const double *q, const double *v, const double *a);

/* The root's six equations under a wrench about the world's origin. The first joint is free.
 *
 * residual: (6); by_state: (6 x (3 nv + 12)) by q, v, a and either of two wrenches. */
void tree_root(Tree *tree, const double *q, const double *v, const double *a, const double *wrench, double *residual,
               double *by_state);

#endif
