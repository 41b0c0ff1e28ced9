/* Joints' rotations from neutral as readings of the configuration, and their limits. */
#include "tree.h"

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

void mbkf_posture_information(Tree *tree, const double *residual, const double *jacobian, const double *weights,
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

static int is_within(const double *angles, const double *lower, const double *upper)
{
    for (int i = 0; i < 3; i++)
        if (!(angles[i] >= lower[i] && angles[i] <= upper[i]))
            return 0;
    return 1;
}

/* The same rotation by the other way round, beyond half a turn. */
static int is_within_other_way_round(const double *angles, const double *lower, const double *upper)
{
    const double scale = 1.0 - 2.0 * acos(-1.0) / sqrt(dot3(angles, angles));
    const double other[3] = {scale * angles[0], scale * angles[1], scale * angles[2]};
    return is_within(other, lower, upper);
}

int mbkf_limit_excess(Tree *tree, const double *angles, const double *lower, const double *upper, double *excess)
{
    int count = 0;
    memset(excess, 0, tree->nv * sizeof *excess);
    for (int i = 1; i < tree->joints; i++) {
        const Joint *joint = &tree->joint[i];
        const int first = joint->at_v;
        const double *angle = angles + first, *low = lower + first, *high = upper + first;
        int own = 0;
        for (int k = 0; k < joint->dofs; k++)
            own += angle[k] < low[k] || angle[k] > high[k];
        if (!own || (joint->kind == SPHERICAL && is_within_other_way_round(angle, low, high)))
            continue;
        count += own;
        for (int k = 0; k < joint->dofs; k++)
            excess[first + k] = angle[k] < low[k] ? angle[k] - low[k] : angle[k] > high[k] ? angle[k] - high[k] : 0.0;
    }
    return count;
}
