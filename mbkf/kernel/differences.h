/* Third differences of readings; see mbkf/sensors/white_noise.py. */
#ifndef MBKF_DIFFERENCES_H
#define MBKF_DIFFERENCES_H

#include <math.h>

/* How many third differences of four samples are numbers, and how many of these lie below a level. */
static inline void third_differences(long count, const double *const samples[4], double level, long *known, long *below)
{
    *known = *below = 0;
    for (long i = 0; i < count; i++) {
        const double third = fabs(samples[3][i] - 3.0 * samples[2][i] + 3.0 * samples[1][i] - samples[0][i]);
        *known += third >= 0.0;
        *below += third < level;
    }
}

#endif
