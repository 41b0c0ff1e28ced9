/* Both feet of a body, and what plates read of their wrenches; see feet.c. */
#ifndef MBKF_FEET_H
#define MBKF_FEET_H

#include "tree.h"

enum { SOLE_POINTS = 3 };

/* Heel, ball and toe end of right and left sole, and the root. */
typedef struct {
    int foot[2], root;                  /* joints */
    double local[2][SOLE_POINTS][3];    /* in their frames */
} Soles;

/* Where they are, and how they move. */
typedef struct {
    double points[2][SOLE_POINTS][3], velocities[2][SOLE_POINTS][3], middles[2][3];
    double up[2]; /* vertical component of each foot's upward axis */
    double root[3];
} Feet;

/* Feet of a tree that is placed, at a velocity (nv). */
void feet_at(const Tree *tree, const Soles *soles, const double *v, Feet *feet);

/* Twelve whitened rows on right and left foot's wrench w (12): weight times (X w - X expected), X from the world's
 * origin to a centre. rows (12 x 12) and values (12) of the first foot stand first. */
void foot_rows(const double centres[2][3], const double weights[2][6], const double *expected, const double *w,
               int first, double *rows, double *values);

/* Adds the random walk (sd (6) about each centre) to the wrenches' blocks of a covariance P (N x N). */
void foot_walks(const double centres[2][3], const double *sd, int first, int N, double *P);

#endif
