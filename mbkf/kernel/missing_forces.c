/* Mean forces that are missing over windows that end now: RunningBalance of mbkf/trial/loads/running.py. */
#include <math.h>
#include <string.h>

#include "declared.h"
#include "vectorised.h"

/* Share of a limit that the forces (longer x 3) of all its windows exceed in one direction along any axis. */
static double exceeded_by_all(int longer, const double *limits, const double *missing, int axis)
{
    double most = -INFINITY;
    for (; axis < 3; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (int k = 0; k < longer; k++) {
            const double share = missing[3 * k + axis] / limits[k];
            low = fmin(low, share);
            high = fmax(high, share);
        }
        most = fmax(most, fmax(low, -high));
    }
    return most;
}

/* Mean force over a window that ends with the last of n frames. */
VECTORISED static void missing_over(int n, int length, const double *by_position, const double *by_force,
                                    const double *held, double mass, const double *gravity, double *missing)
{
    double required[3] = {-gravity[0], -gravity[1], -gravity[2]}, carried[3] = {0.0, 0.0, 0.0};
    for (int t = n - length; t < n; t++)
        for (int i = 0; i < 3; i++) {
            required[i] += by_position[t] * held[6 * t + i];
            carried[i] += by_force[t] * held[6 * t + 3 + i];
        }
    for (int i = 0; i < 3; i++)
        missing[i] = mass * required[i] - carried[i];
}

void mbkf_missing_forces(int w, int n, int l, int longer, const double *by_position, const double *by_force,
                         const int *lengths, const double *limits, const double *held, int known, double mass,
                         const double *gravity, int level, double *missing, double *exceeded, double *swings)
{
    const int axis = level ? 0 : 2;
    memset(missing, 0, sizeof *missing * 3 * w);
    for (int k = 0; k < w; k++)
        if (lengths[k] <= known)
            missing_over(n, lengths[k], by_position + (long)k * n, by_force + (long)k * n, held, mass, gravity,
                         missing + 3 * k);
    for (int k = 0; k < l; k++, missing += 3 * longer, limits += longer) {
        exceeded[k] = exceeded_by_all(longer, limits, missing, axis);
        swings[k] = 0.0;
        for (int i = axis; i < 3; i++)
            swings[k] = fmax(swings[k], fabs(missing[i] / limits[0]));
    }
}
