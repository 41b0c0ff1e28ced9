/* Variances of the angles and rates of joints with three angles: diagonals of E C E' with the rates' matrix E of
 * mbkf/numerics/cardan.py, from rotation matrices alone, without an angle. */
#include <math.h>

#include "declared.h"

static const double LEAST_COSINE = 1e-9;

/* Rotation matrix of a unit quaternion (x, y, z, w). */
static void rotation(const double *u, double R[3][3])
{
    const double x = u[0], y = u[1], z = u[2], w = u[3];
    const double rows[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                               {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                               {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            R[i][j] = rows[i][j];
}

/* E (angles x axes i, j, k), as rate_map of mbkf/numerics/cardan.py for the principal angles of R. */
static void rates(const double *u, const int *axis, const double *signs, double E[3][3])
{
    double R[3][3];
    rotation(u, R);
    const double r00 = R[axis[0]][axis[0]], r01 = R[axis[0]][axis[1]], r02 = R[axis[0]][axis[2]];
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

/* E of the root's position: axes R. */
static void root_rates(const double *u, const double *axes, double E[3][3])
{
    double R[3][3];
    rotation(u, R);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            E[i][j] = axes[3 * i] * R[0][j] + axes[3 * i + 1] * R[1][j] + axes[3 * i + 2] * R[2][j];
}

void mbkf_joint_variances(int nq, int n, int k, const double *q, const int *quaternions, const int *axes,
                          const double *signs, int root, const double *root_axes, const double *covariance,
                          double *variance)
{
    (void)nq;
    for (int b = 0; b <= n; b++) {
        double E[3][3];
        if (b < n)
            rates(q + quaternions[b], axes + 3 * b, signs + 4 * b, E);
        else
            root_rates(q + root, root_axes, E);
        for (int set = 0; set < k; set++) {
            const long at = (long)set * (n + 1) + b;
            const double *C = covariance + 9 * at;
            for (int angle = 0; angle < 3; angle++) {
                double sum = 0.0;
                for (int i = 0; i < 3; i++)
                    for (int j = 0; j < 3; j++)
                        sum += E[angle][i] * C[3 * i + j] * E[angle][j];
                variance[3 * at + angle] = sum;
            }
        }
    }
}
