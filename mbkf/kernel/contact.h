/* Contact of the feet, decided in one frame; see contact.c. */
#ifndef MBKF_CONTACT_H
#define MBKF_CONTACT_H

#include "floor_motion.h"

enum { UNMEASURED = -1, AIR = 0, MEASURED = 1, SHARED = 2 };
enum { BOTH = 2, NONE = -1 };

/* What the decision says besides kinds (those of right and left foot, plus one, in two bits each). */
enum { STRAY = 16, ON_ONE_PLATE = 32, ON_OPEN_FLOOR = 64, MOVING_OR_NEAR = 128, BELOW = 256 };

/* State and readings of a frame. */
typedef struct {
    const double *q, *v, *a, *wrench; /* the last (plates x 6), NaN where not recorded */
    int supported;
} Seen;

/* Filled: measured wrenches, middles of the soles, what small readings sum to, and for what is rarely asked both
 * soles, pelvis, nearness of right and left foot to the floor, and the floor's velocity. */
typedef struct {
    double *wrench, *middles, *below, *rest;
} Told;

int contact_decided(const Feet *feet, const Seen *seen, const double *before, double *after, const Told *told);

#endif
