/* Mean forces that are missing over windows that end now: RunningBalance of mbkf/trial/loads/running.py. */
#include <string.h>

#include "declared.h"
#include "vectorised.h"

VECTORISED void mbkf_missing_forces(int w, int n, const double *by_position, const double *by_force, const int *lengths,
                                    const double *held, int known, double mass, const double *gravity, double *missing)
{
    memset(missing, 0, sizeof *missing * 3 * w);
    for (int k = 0; k < w; k++, by_position += n, by_force += n, missing += 3) {
        double required[3] = {-gravity[0], -gravity[1], -gravity[2]}, carried[3] = {0.0, 0.0, 0.0};
        if (lengths[k] > known)
            continue;
        for (int t = n - lengths[k]; t < n; t++)
            for (int i = 0; i < 3; i++) {
                required[i] += by_position[t] * held[6 * t + i];
                carried[i] += by_force[t] * held[6 * t + 3 + i];
            }
        for (int i = 0; i < 3; i++)
            missing[i] = mass * required[i] - carried[i];
    }
}
