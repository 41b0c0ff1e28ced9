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

/* tau (nv) and its derivatives by q, v, a and the feet's wrenches, of which those that are not zero are written: nv rows
 * of columns that are m numbers apart. Composites and their derivatives are those of tree_force_derivatives then. */
void tree_torques(Tree *tree, const double *q, const double *v, const double *a, const char *moves,
                  const double *wrenches, long m, double *tau, double *by_state);

/* Force of a part that moves with the root, after tree_forces; and the part's motion and inertia. */
void tree_part(const Tree *tree, const Joint *part, Composite *one);

/* Sum of the segments that a joint carries and of a part that moves with the root, and its derivatives by the root's six
 * dofs, after tree_force_derivatives. */
void tree_upper(const Tree *tree, const Joint *part, int above, Composite *upper, Derivative *by);

#endif
