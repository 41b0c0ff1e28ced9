/* Standard deviations of clinical coordinates and their rates (mbkf/filters/coordinate_variances.py). Of joints with three
 * angles variances are diagonals of E C E', where E maps angular velocity to rates of angles (rate_map of
 * mbkf/numerics/cardan.py); E follows from the rotation matrix, without an angle. */
#include <math.h>
#include <string.h>

#include "declared.h"
#include "rotation.h"

static const double LEAST_COSINE = 1e-9;

/* E (angles x axes) of a joint whose angles turn about the axes i, j and k in this order. */
static void rates(const double *u, const int *axis, const double *signs, double E[3][3])
{
    double R[9];
    rotation_matrix(u, R);
    const double *row = R + axis[0], r00 = row[3 * axis[0]], r01 = row[3 * axis[1]], r02 = row[3 * axis[2]];
    const double length = hypot(r00, r01);
    const double cos_c = length > 0.0 ? r00 / length : 1.0, sin_c = length > 0.0 ? -r01 / length : 0.0;
    const double size = hypot(length, r02), cosine = length / size;
    const double cos_b = cosine < LEAST_COSINE ? LEAST_COSINE : cosine, tan_b = r02 / size / cos_b;
    const double rows[3][3] = {
        {cos_c / cos_b, -sin_c / cos_b, 0.0}, {sin_c, cos_c, 0.0}, {-tan_b * cos_c, tan_b * sin_c, 1.0}};
    for (int angle = 0; angle < 3; angle++)
        for (int i = 0; i < 3; i++)
            E[angle][axis[i]] = signs[1 + angle] * rows[angle][i];
}

/* E of the root's position, in axes of its own: axes R. */
static void root_rates(const double *u, const double *axes, double E[3][3])
{
    double R[9];
    rotation_matrix(u, R);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            E[i][j] = axes[3 * i] * R[3 * j] + axes[3 * i + 1] * R[3 * j + 1] + axes[3 * i + 2] * R[3 * j + 2];
}

/* diagonal of E C E', C (3 x 3) row by row */
static void angle_variances(const double E[3][3], const double *C, const int *columns, double *variance)
{
    for (int angle = 0; angle < 3; angle++) {
        double sum = 0.0;
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                sum += E[angle][i] * C[3 * i + j] * E[angle][j];
        variance[columns[angle]] = sum;
    }
}

void mbkf_coordinate_deviations(int nq, int n, int k, int A, int nv, const double *q, const int *quaternions,
                                const int *axes, const double *signs, int root, const double *root_axes,
                                const int *dofs, const int *columns, const int *single_dofs,
                                const int *single_columns, const double *zero, const double *position,
                                const double *velocity, const double *blocks, const double *offset,
                                const double *rate_offset, const double *offset_blocks,
                                const double *rate_offset_blocks, double *deviations)
{
    enum { SETS = 4 };
    const double *diagonals[SETS] = {position, velocity, offset, rate_offset};
    const double *covariances[SETS] = {blocks, NULL, offset_blocks, rate_offset_blocks};
    (void)nq, (void)nv;
    memset(deviations, 0, sizeof *deviations * SETS * A);
    for (int b = 0; b <= n; b++) {
        const double rate[3] = {velocity[dofs[3 * b]], velocity[dofs[3 * b + 1]], velocity[dofs[3 * b + 2]]};
        const double independent[9] = {rate[0], 0.0, 0.0, 0.0, rate[1], 0.0, 0.0, 0.0, rate[2]};
        double E[3][3];
        if (b < n)
            rates(q + quaternions[b], axes + 3 * b, signs + 4 * b, E);
        else
            root_rates(q + root, root_axes, E);
        for (int set = 0; set < SETS; set++) {
            const double *C = set == 1 ? independent : covariances[set] ? covariances[set] + 9 * b : NULL;
            if (C)
                angle_variances(E, C, columns + 3 * b, deviations + set * A);
        }
    }
    for (int set = 0; set < SETS; set++)
        for (int i = 0; i < k && diagonals[set]; i++)
            deviations[set * A + single_columns[i]] = diagonals[set][single_dofs[i]];
    for (int i = 0; i < SETS * A; i++)
        if (deviations[i] < 0.0) /* zero, but for rounding; NaN stays */
            deviations[i] = 0.0;
    for (int i = 0; i < A && offset; i++)
        deviations[2 * A + i] += zero[i];
    for (int i = 0; i < 2 * A; i++)
        deviations[i] += deviations[2 * A + i];
    for (int i = 0; i < SETS * A; i++)
        deviations[i] = sqrt(deviations[i]);
}
