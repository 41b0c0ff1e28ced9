/* Readings and random walks of the feet's wrenches about the middles c of the soles, with S = [1, 0; [c]x, 1]:
 *
 *     rows diag(1/sd) S(-c)      of FootContact.linearise (mbkf/sensors/foot_contact.py), feet read one by one
 *     P += S(c) diag(sd^2) S(c)'   of FootContact.inflate
 *
 * and readings of plates: all_possible (mbkf/sensors/contact/possible.py), PlateBuffer.mean
 * (mbkf/stream/receiving/plate_buffer.py), StrayLoad (mbkf/trial/loads/running.py), PlateNoise.after
 * (mbkf/sensors/contact/plate_noise.py). */
#include <math.h>
#include <string.h>

#include "declared.h"
#include "rotation.h"

void mbkf_wrench_rows(const double *middles, const double *right, const double *left, const double *expected,
                      const double *w, int left_first, double *rows, double *values)
{
    const double *const weights[2] = {right, left};
    memset(rows, 0, 144 * sizeof *rows);
    for (int f = 0; f < 2; f++) {
        const int at = 6 * (f != left_first);
        double lever[9];
        cross_matrix(middles + 3 * f, lever);
        for (int i = 0; i < 6; i++) {
            const double weight = weights[f][i];
            double *row = rows + 12 * (at + i) + 6 * f, value = 0.0;
            if (i >= 3)
                for (int j = 0; j < 3; j++)
                    row[j] = -weight * lever[3 * (i - 3) + j];
            row[i] = weight;
            for (int j = 0; j < 6; j++)
                value += row[j] * (expected[6 * f + j] - w[6 * f + j]);
            values[at + i] = value;
        }
    }
}

void mbkf_add_wrench_walk(int N, double *P, int first, const double *middles, const double *sd, const double *belt)
{
    const double force = sd[0] * sd[0], moment = sd[1] * sd[1];
    for (int f = 0; f < 2; f++) {
        const double *c = middles + 3 * f, square = dot3(c, c);
        double *own = P + (size_t)(first + 6 * f) * (N + 1), lever[9];
        cross_matrix(c, lever);
        for (int i = 0; i < 3; i++) {
            own[i * (N + 1)] += force;
            for (int j = 0; j < 3; j++) {
                own[(3 + i) * N + j] += force * lever[3 * i + j];
                own[j * N + 3 + i] += force * lever[3 * i + j];
                own[(3 + i) * N + 3 + j] += (i == j ? force * square + moment : 0.0) - force * c[i] * c[j];
                if (i < 2 && j < 2)
                    own[(3 + i) * N + 3 + j] += belt[i] * belt[j];
            }
        }
    }
}

int mbkf_wrenches_possible(int n, int plates, const double *readings, const double *reach, const PossibleLoads *limits)
{
    const double W = limits->weight_n;
    const long count = (long)n * plates;
    int possible = 1;
    for (long s = 0; s < count; s++) {
        const double *w = readings + 6 * s, vertical = w[2], farthest = reach[s % plates];
        const double bears = vertical + limits->slack * W, least = bears > 0.0 ? bears : 0.0;
        /* NaN compares as false. */
        possible &= fabs(vertical) <= limits->most * W && vertical >= -limits->pull * W &&
                    hypot(w[0], w[1]) <= limits->friction * least && hypot(w[3], w[4]) <= farthest * least &&
                    fabs(w[5]) <= limits->friction * farthest * least;
    }
    return possible;
}

void mbkf_wrench_means(int size, int n, int plates, const double *ring, int first, const double *weights, double width,
                       const double *origins, double *means)
{
    memset(means, 0, 6 * plates * sizeof *means);
    for (int i = 0; i < n; i++) {
        const double *row = ring + ((long)first + i) % size * 6 * plates;
        for (int c = 0; c < 6 * plates; c++)
            means[c] += weights[i] * row[c];
    }
    for (int k = 0; k < plates; k++) {
        const double *o = origins + 3 * k;
        double *mean = means + 6 * k, sum = 0.0;
        for (int c = 0; c < 6; c++)
            sum += mean[c] /= width;
        mean[3] += o[1] * mean[2] - o[2] * mean[1];
        mean[4] += o[2] * mean[0] - o[0] * mean[2];
        mean[5] += o[0] * mean[1] - o[1] * mean[0];
        for (int c = 0; c < 6 && isnan(sum); c++)
            mean[c] = NAN;
    }
}

int mbkf_plate_total(int plates, const double *wrenches, double *force)
{
    int finite = 1;
    force[0] = force[1] = force[2] = 0.0;
    for (int k = 0; k < plates; k++)
        for (int c = 0; c < 6; c++) {
            const double read = wrenches[6 * k + c];
            finite &= isfinite(read) != 0;
            if (c < 3 && !isnan(read))
                force[c] += read;
        }
    return finite;
}

void mbkf_plate_loads(int plates, const double *origins, const double *wrenches, double *force, double *moment)
{
    for (int k = 0; k < plates; k++, origins += 3, wrenches += 6, force += 3, moment += 3) {
        double turned[3];
        cross(origins, wrenches, turned);
        for (int i = 0; i < 3; i++) {
            force[i] = wrenches[i];
            moment[i] = wrenches[3 + i] - turned[i];
        }
    }
}
