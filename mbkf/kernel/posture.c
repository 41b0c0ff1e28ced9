/* Joints' rotations from neutral as readings of the configuration. */
#include "posture.h"

#include <math.h>
#include <string.h>

static void add_block(long nv, long first, int dofs, const double *residual, const double *jacobian,
                      const double *weights, double *matrix, double *vector)
{
    for (long r = first; r < first + dofs; r++) {
        const double *row = jacobian + r * nv, weight = weights[r] * weights[r];
        if (weight == 0.0)
            continue;
        for (long i = first; i < first + dofs; i++) {
            vector[i] -= weight * residual[r] * row[i];
            for (long j = first; j < first + dofs; j++)
                matrix[i * nv + j] += weight * (row[i] * row[j]);
        }
    }
}

void tree_posture(const Tree *tree, const double *residual, const double *jacobian, const double *weights,
                  double *matrix, double *vector)
{
    const long nv = tree->nv;
    memset(matrix, 0, nv * nv * sizeof *matrix);
    memset(vector, 0, nv * sizeof *vector);
    for (int i = 1; i < tree->joints; i++) {
        const Joint *joint = &tree->joint[i];
        if (joint->kind != FREE)
            add_block(nv, joint->at_v, joint->dofs, residual, jacobian, weights, matrix, vector);
    }
}

static int within(const double *turn, const double *lower, const double *upper)
{
    for (int i = 0; i < 3; i++)
        if (!(turn[i] >= lower[i] && turn[i] <= upper[i]))
            return 0;
    return 1;
}

static int within_other_way_round(const double *turn, const double *lower, const double *upper)
{
    const double scale = 1.0 - 2.0 * acos(-1.0) / sqrt(dot3(turn, turn));
    const double other[3] = {scale * turn[0], scale * turn[1], scale * turn[2]};
    return within(other, lower, upper);
}

int tree_beyond(const Tree *tree, const double *deviation, const double *lower, const double *upper, double *beyond)
{
    int passed = 0;
    memset(beyond, 0, tree->nv * sizeof *beyond);
    for (int i = 1; i < tree->joints; i++) {
        const Joint *joint = &tree->joint[i];
        const int first = joint->at_v;
        const double *turn = deviation + first, *low = lower + first, *high = upper + first;
        int mine = 0;
        for (int k = 0; k < joint->dofs; k++)
            mine += turn[k] < low[k] || turn[k] > high[k];
        if (!mine || (joint->kind == SPHERICAL && within_other_way_round(turn, low, high)))
            continue;
        passed += mine;
        for (int k = 0; k < joint->dofs; k++)
            beyond[first + k] = turn[k] < low[k] ? turn[k] - low[k] : turn[k] > high[k] ? turn[k] - high[k] : 0.0;
    }
    return passed;
}
