/* Readings and random walks of the feet's wrenches; see wrenches.c. Wrenches are force and moment about the world's
 * origin, of the right and then of the left foot; middles are those of the soles. */
#ifndef MBKF_WRENCHES_H
#define MBKF_WRENCHES_H

/* Fills rows (12 x 12) and innovations (12): each foot's wrench about its middle, by weights (6) of the right and of the
 * left foot, is read to be as expected (2 x 6). The rows of one foot come first. */
void wrench_rows(const double *middles, const double *const weights[2], const double *expected, const double *w,
                 int first, double *rows, double *values);

/* What a person can make a plate read: multiples of the weight W that vertical forces, pulls and shear keep below, and
 * what is added to a vertical force before shear and moments are compared with it. */
typedef struct {
    double weight, most, pull, friction, slack;
} Possible;

/* Whether all readings (count x 6), of plates in turn that are pressed no farther than reach (plates) from their
 * origins, are possible; see mbkf/sensors/contact/possible.py. */
int wrenches_possible(long count, const double *readings, int plates, const double *reach, const Possible *limits);

/* Means (plates x 6) of plates' readings over a window, and moved from the plates' origins (plates x 3) to the world's:
 * weights (n) of the rows from first on in a ring of so many rows (rows x 6 plates), over the window's width. What is
 * not a number in one component is not a number in any. */
void wrench_means(const double *ring, long rows, int plates, long first, int n, const double *weights, double width,
                  const double *origins, double *means);

/* Adds to a covariance (N x N), from that of the wrenches' first component on: random walks about the middles, with
 * standard deviations of force and moment, and how a belt takes the horizontal moments along (2). */
void wrench_walk(double *P, int N, int at, const double *middles, const double *sd, const double *belt);

#endif
