/* Generalised forces of a body under its feet's wrenches; see torques.c. */
#ifndef MBKF_TORQUES_H
#define MBKF_TORQUES_H

/* tau (nv) and by_state (nv x 3 nv + 12) of mbkf/model/newton_euler.py from those of inverse dynamics alone.
 *
 * free: (nv); by_q, by_v: (nv x nv), row by row; by_a: (nv x nv), symmetric; J: (6 x nv) velocities at the world's
 * origin; it and by_state column by column.
 * moves: (2 x nv) whether a dof moves a foot, row by row; joint_of: (nv); wrenches: (12). */
void torques(int nv, const double *free, const double *by_q, const double *by_v, const double *by_a,
             const double *J, const int *moves, const int *joint_of, const double *wrenches, double *tau,
             double *by_state);

#endif
