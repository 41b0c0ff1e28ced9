/* Generalised forces of a tree under its feet's wrenches; see torques.c. */
#ifndef MBKF_TORQUES_H
#define MBKF_TORQUES_H

#include "tree.h"

/* tau (nv) of mbkf/model/newton_euler.py. moves: (2 x nv) whether a dof moves a foot; wrenches: (12). */
void tree_tau(Tree *tree, const double *q, const double *v, const double *a, const int *moves, const double *wrenches,
              double *tau);

/* The same, and by_state (nv x (3 nv + 12), column by column) by q, v, a and both wrenches. */
void tree_torques(Tree *tree, const double *q, const double *v, const double *a, const int *moves,
                  const double *wrenches, double *tau, double *by_state);

#endif
