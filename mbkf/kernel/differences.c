/* Third differences of readings; see mbkf/sensors/white_noise.py. */
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
