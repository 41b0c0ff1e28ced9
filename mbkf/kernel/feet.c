/* Both feet as mbkf/sensors/contact/feet.py looks at them, and the rows of mbkf/sensors/foot_contact.py. */
#include "feet.h"

#include <string.h>

/* Velocity of a joint's frame at the world's origin, linear and angular. */
static void twist_of(const Tree *tree, int joint, const double *v, double *twist)
{
    memset(twist, 0, 6 * sizeof *twist);
    for (; joint; joint = tree->joint[joint].parent) {
        const Joint *one = &tree->joint[joint];
        for (int d = one->at_v; d < one->at_v + one->dofs; d++)
            for (int i = 0; i < 6; i++)
                twist[i] += tree->axes[d][i] * v[d];
    }
}

void feet_at(const Tree *tree, const Soles *soles, const double *v, Feet *feet)
{
    for (int f = 0; f < 2; f++) {
        const double *frame = tree->frames + 12 * soles->foot[f];
        double twist[6];
        twist_of(tree, soles->foot[f], v, twist);
        for (int k = 0; k < SOLE_POINTS; k++) {
            double *point = feet->points[f][k], *velocity = feet->velocities[f][k];
            turned(frame, soles->local[f][k], point);
            for (int i = 0; i < 3; i++)
                point[i] += frame[9 + i];
            cross(twist + 3, point, velocity);
            for (int i = 0; i < 3; i++)
                velocity[i] += twist[i];
        }
        for (int i = 0; i < 3; i++)
            feet->middles[f][i] = 0.5 * (feet->points[f][0][i] + feet->points[f][SOLE_POINTS - 1][i]);
        feet->up[f] = frame[8];
    }
    memcpy(feet->root, tree->frames + 12 * soles->root + 9, sizeof feet->root);
}

/* Moment of a wrench about a point: n - c x f, as a matrix (3 x 6) row by row. */
static void moment_about(const double *c, double *rows)
{
    const double matrix[18] = {0.0, c[2], -c[1], 1.0, 0.0, 0.0, -c[2], 0.0, c[0],
                               0.0, 1.0,  0.0,   c[1], -c[0], 0.0, 0.0, 0.0, 1.0};
    memcpy(rows, matrix, sizeof matrix);
}

void foot_rows(const double centres[2][3], const double weights[2][6], const double *expected, const double *w,
               int first, double *rows, double *values)
{
    memset(rows, 0, 144 * sizeof *rows);
    for (int k = 0; k < 2; k++) {
        const int foot = k ? 1 - first : first;
        double X[36] = {0.0};
        X[0] = X[7] = X[14] = 1.0;
        moment_about(centres[foot], X + 18);
        for (int i = 0; i < 6; i++) {
            double *row = rows + 12 * (6 * k + i) + 6 * foot, value = 0.0;
            for (int j = 0; j < 6; j++) {
                row[j] = weights[foot][i] * X[6 * i + j];
                value += row[j] * (expected[6 * foot + j] - w[6 * foot + j]);
            }
            values[6 * k + i] = value;
        }
    }
}

void foot_walks(const double centres[2][3], const double *sd, int first, int N, double *P)
{
    for (int f = 0; f < 2; f++) {
        const double back[3] = {-centres[f][0], -centres[f][1], -centres[f][2]};
        double S[36] = {0.0};
        S[0] = S[7] = S[14] = 1.0;
        moment_about(back, S + 18);
        for (int i = 0; i < 6; i++)
            for (int j = 0; j < 6; j++)
                S[6 * i + j] *= sd[j];
        for (int i = 0; i < 6; i++)
            for (int j = 0; j < 6; j++) {
                double sum = 0.0;
                for (int k = 0; k < 6; k++)
                    sum += S[6 * i + k] * S[6 * j + k];
                P[(long)(first + 6 * f + i) * N + first + 6 * f + j] += sum;
            }
    }
}
