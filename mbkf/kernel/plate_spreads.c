/* Spreads of wrenches about the world's origin that are independent about points, and changes within a frame:
 * mbkf/sensors/contact/plate_noise.py. */
#include <math.h>

#include "declared.h"

/* The origin that a point is nearest to; the point itself where there is none. */
static const double *nearest(int K, const double *origins, const double *point)
{
    const double *found = K ? origins : point;
    double least = INFINITY;
    for (int k = 0; k < K; k++) {
        double square = 0.0;
        for (int i = 0; i < 3; i++) {
            const double away = point[i] - origins[3 * k + i];
            square += away * away;
        }
        if (square < least) {
            least = square;
            found = origins + 3 * k;
        }
    }
    return found;
}

void mbkf_plate_spreads(int K, int n, const double *origins, const double *points, double force, double moment,
                        double *spreads)
{
    for (int p = 0; p < n; p++, spreads += 6) {
        const double *o = nearest(K, origins, points + 3 * p);
        const double square[3] = {o[0] * o[0], o[1] * o[1], o[2] * o[2]};
        for (int i = 0; i < 3; i++) {
            spreads[i] = force;
            spreads[3 + i] = sqrt((square[(i + 1) % 3] + square[(i + 2) % 3]) * (force * force) + moment * moment);
        }
    }
}

void mbkf_plate_changes(int n, const double *change, const double *noise, double white, double share,
                        double share_of_second, double *within)
{
    const double *second = change + 6L * n;
    for (long i = 0; i < 6L * n; i++) {
        const double expected = white * noise[i], beyond = second[i] * second[i] - expected * expected;
        within[i] = share * change[i];
        within[6L * n + i] = beyond <= 0.0 ? 0.0 : share_of_second * copysign(sqrt(beyond), second[i]);
    }
}
