/* Generalised forces of a body under its feet's wrenches, tau = ID(q, v, a) - sum of J' w, and their derivatives. */
#include "torques.h"

#include <string.h>

static void cross(const double *a, const double *b, double *c)
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot6(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5];
}

/* X J_k with (J_k x J_i) . w = J_i' X J_k: what a turn by dof k changes (_turned_wrench of newton_euler.py). */
static void turned(const double *w, const double *column, double *found)
{
    double moment[3];
    cross(w, column + 3, found);
    cross(w, column, found + 3);
    cross(w + 3, column + 3, moment);
    for (int i = 0; i < 3; i++)
        found[3 + i] += moment[i];
}

static void transposed(int n, const double *A, double *B)
{
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++)
            B[(long)j * n + i] = A[(long)i * n + j];
}

void torques(int nv, const double *free, const double *by_q, const double *by_v, const double *by_a,
             const double *J, const int *moves, const int *joint_of, const double *wrenches, double *tau,
             double *by_state)
{
    const long block = (long)nv * nv;
    memcpy(tau, free, sizeof(double) * nv);
    transposed(nv, by_q, by_state);
    transposed(nv, by_v, by_state + block);
    memcpy(by_state + 2 * block, by_a, sizeof(double) * block);
    for (int foot = 0; foot < 2; foot++) {
        const int *own = moves + (long)foot * nv;
        const double *w = wrenches + 6 * foot;
        double *by_wrench = by_state + 3 * block + 6L * foot * nv;
        for (int k = 0; k < nv; k++) {
            const double *column = J + 6L * k;
            for (int c = 0; c < 6; c++)
                by_wrench[(long)c * nv + k] = own[k] ? -column[c] : 0.0;
            if (!own[k])
                continue;
            double change[6];
            tau[k] -= dot6(column, w);
            turned(w, column, change);
            for (int i = 0; i < nv; i++)
                if (own[i] && joint_of[i] >= joint_of[k])
                    by_state[(long)k * nv + i] -= dot6(J + 6L * i, change);
        }
    }
}
