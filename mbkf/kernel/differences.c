/* Third differences of readings (mbkf/sensors/white_noise.py), mean activity of a motion (mbkf/filters/dynamic/plant.py)
 * and its bounds (mbkf/filters/plausibility.py). */
#include <math.h>

#include "declared.h"

void mbkf_third_differences(int count, const double *first, const double *second, const double *third,
                            const double *latest, double level, int *known, int *below)
{
    *known = *below = 0;
    for (int i = 0; i < count; i++) {
        const double difference = fabs(latest[i] - 3.0 * third[i] + 3.0 * second[i] - first[i]);
        *known += difference >= 0.0;
        *below += difference < level;
    }
}

void mbkf_mean_activity(int nv, const double *v, const double *a, const double *before, double rate, double share,
                        double *after)
{
    for (int i = 0; i < nv; i++) {
        const double now = a[i] * a[i] + rate * v[i] * (rate * v[i]);
        after[i] = before ? before[i] + share * (now - before[i]) : now;
    }
}

int mbkf_is_possible(int nq, int nv, int k, const double *q, const double *v, const double *a, const double *wrenches,
                     double rate, double force)
{
    double squares = 0.0;
    int possible = 1;
    for (int i = 0; i < nq; i++)
        squares += q[i] * q[i];
    for (int i = 0; i < nv; i++) {
        squares += a[i] * a[i];
        possible &= fabs(v[i]) <= rate; /* NaN is not */
    }
    for (int f = 0; f < k; f++)
        for (int i = 0; i < 3; i++)
            possible &= !(fabs(wrenches[6 * f + i]) > force);
    return possible && isfinite(squares);
}
