/* Readings and random walks of the feet's wrenches; see wrenches.c. Wrenches are force and moment about the world's
 * origin, of the right and then of the left foot; middles are those of the soles. */
#ifndef MBKF_WRENCHES_H
#define MBKF_WRENCHES_H

/* Fills rows (12 x 12) and innovations (12): each foot's wrench about its middle, by weights (6) of the right and of the
 * left foot, is read to be as expected (2 x 6). The rows of one foot come first. */
void wrench_rows(const double *middles, const double *const weights[2], const double *expected, const double *w,
                 int first, double *rows, double *values);

/* Adds to a covariance (N x N), from that of the wrenches' first component on: random walks about the middles, with
 * standard deviations of force and moment, and how a belt takes the horizontal moments along (2). */
void wrench_walk(double *P, int N, int at, const double *middles, const double *sd, const double *belt);

#endif
