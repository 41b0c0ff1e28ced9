/* Markers on a tree: where they are, how far measured ones lie off, and what they say of the posture; see markers.c. */
#ifndef MBKF_MARKERS_H
#define MBKF_MARKERS_H

#include "tree.h"

/* Markers fixed to joints' segments. */
typedef struct {
    int count;
    const int *joint;    /* (count) */
    const double *local; /* (count x 3) */
} Markers;

/* Places (count x 3) with the tree placed. */
void markers_placed(const Tree *tree, const Markers *markers, double *places);

/* Measured less predicted places, their squared lengths (0 of missing ones), and which are seen. How many are seen;
 * -1 where one of them lies further off than a radius. */
int markers_apart(int count, const double *measured, const double *places, double radius, double *innovation,
                  double *squared, char *seen);

/* Information matrix (nv x nv) and vector (nv) of readings with weights 1/sd^2, and their y' R^-1 y. axes (nv x 6) are
 * the velocities of what a dof moves; composites (joints) is memory to work in. */
double markers_information(const Tree *tree, const Markers *markers, const double *weights, const char *trusted,
                           const double *axes, const double *places, const double *innovation, double *matrix,
                           double *vector);

#endif
