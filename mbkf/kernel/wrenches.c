/* FootContact.linearise, of feet that do not bear together, and FootContact.inflate of mbkf/sensors/foot_contact.py. */
#include "wrenches.h"

#include <string.h>

#include "rotation.h"

void wrench_rows(const double *middles, const double *const weights[2], const double *expected, const double *w,
                 int first, double *rows, double *values)
{
    memset(rows, 0, 144 * sizeof *rows);
    for (int f = 0; f < 2; f++) {
        const int at = 6 * (f != first);
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

/* With S = [1 0; [c]x 1] of a middle c, S diag(sd^2) S'. */
void wrench_walk(double *P, int N, int at, const double *middles, const double *sd, const double *belt)
{
    const double force = sd[0] * sd[0], moment = sd[1] * sd[1];
    for (int f = 0; f < 2; f++) {
        const double *c = middles + 3 * f, square = dot3(c, c);
        double *own = P + (size_t)(at + 6 * f) * (N + 1), lever[9];
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
