/* Innovations in units of their running spread, and the spread after them: InnovationSpreads of
 * mbkf/filters/innovations.py, with RunningSpread.followed of mbkf/numerics/running_spread.py. */
#include <math.h>
#include <string.h>

#include "declared.h"

static inline double within(double x, double least, double most) { return fmin(fmax(x, least), most); }

void mbkf_judge_innovations(int n, int kinds, const double *mean_square, const double *readings, const double *before,
                            const double *frames, const double *least, const double *most, const int *kind,
                            double forget, double *squared, double *counted, double *ratio, double *variance,
                            double *after, double *frames_after)
{
    memset(squared, 0, sizeof *squared * kinds);
    memset(counted, 0, sizeof *counted * kinds);
    for (int i = 0; i < n; i++) {
        const double count = frames[i] > 0.0 ? readings[i] : 0.0;
        variance[i] = within(before[i], least[i], most[i]);
        ratio[i] = mean_square[i] / variance[i];
        squared[kind[i]] += ratio[i] * count;
        counted[kind[i]] += count;
        if (count == 0.0)
            ratio[i] = NAN;
        frames_after[i] = frames[i];
        after[i] = before[i];
        if (readings[i] > 0.0) {
            frames_after[i] += 1.0;
            after[i] += fmax(1.0 / frames_after[i], forget) * (mean_square[i] - before[i]);
        }
    }
}

void mbkf_square_channels(int k, int n, const double *whitened, int readings, int first, int channels,
                          double *mean_square, double *counted)
{
    (void)k, (void)n;
    mean_square += first;
    counted += first;
    memset(mean_square, 0, sizeof *mean_square * channels);
    memset(counted, 0, sizeof *counted * channels);
    for (int i = 0; i < readings; i++) {
        const int channel = i / 3 % channels;
        mean_square[channel] += whitened[i] * whitened[i];
        counted[channel] += 1.0;
    }
    for (int i = 0; i < channels; i++)
        mean_square[i] /= fmax(counted[i], 1.0);
}
