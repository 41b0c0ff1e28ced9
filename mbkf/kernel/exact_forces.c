/* A step of the covariance of (q, v, u) by the exact transition and plant noise (thesis eqs. 2.39, 2.43), as
 * mbkf/numerics/forced_error.py computes them: with A = [[T, 1], [K, D]] of (q, v) and the response U to lasting forces,
 *
 *     W(s) = integral of exp(A t) [0; 1] over 0 ... s = sum of X_j s^(j+1),    E = exp(A dt),    G = W(dt) U,
 *     noise of (q, v) = integral of W U D U' W' by Gauss's rule, with the forces = (integral of W) U D.
 *
 * Matrices stand column by column; X_j is kept transposed (nv x 2 nv). T couples the dofs of one joint only. */
#include <math.h>
#include <string.h>

#include "call.h"
#include "declared.h"
#include "joints.h"
#include "product.h"
#include "symmetric.h"

enum { TERMS = 40, SUMS = 3 };

static const double LARGEST = 5.0, ROUNDING = 1e-15;

/* What a step is made of; m = 2 nv. */
typedef struct {
    int nv, m, J, damped;
    const double *A, *damping; /* damping: D by itself, transposed */
    const int *joints;
} Rates;

static double row_sum(const Rates *rates, int row, int first)
{
    double sum = 0.0;
    for (int k = first; k < first + rates->nv; k++)
        sum += fabs(rates->A[(long)k * rates->m + row]);
    return sum;
}

/* Size of A dt, positions in units that make it least; NaN where A is not finite. */
static double size_of(const Rates *rates, double dt)
{
    double turning = 0.0, stiffness = 0.0, damping = 0.0, all = 0.0;
    for (int i = 0; i < rates->nv; i++) {
        turning = fmax(turning, row_sum(rates, i, 0) + 1.0);
        stiffness = fmax(stiffness, row_sum(rates, rates->nv + i, 0));
        damping = fmax(damping, row_sum(rates, rates->nv + i, rates->nv));
        all += row_sum(rates, i, 0) + row_sum(rates, rates->nv + i, 0) + row_sum(rates, rates->nv + i, rates->nv);
    }
    return dt * fmax(turning, fmax(damping, sqrt(stiffness))) + 0.0 * all;
}

/* out = factor X A'. */
static void advance(const Rates *rates, double factor, const double *X, double *out)
{
    const int nv = rates->nv, m = rates->m;
    const double *moved = X + (long)nv * nv;
    for (int k = 0; k < rates->J; k++)
        for (int i = rates->joints[2 * k]; i < rates->joints[2 * k + 1]; i++) {
            double *to = out + (long)i * nv;
            for (int r = 0; r < nv; r++)
                to[r] = moved[(long)i * nv + r];
            for (int j = rates->joints[2 * k]; j < rates->joints[2 * k + 1]; j++) {
                const double turning = rates->A[(long)j * m + i];
                if (turning != 0.0)
                    for (int r = 0; r < nv; r++)
                        to[r] += turning * X[(long)j * nv + r];
            }
            for (int r = 0; r < nv; r++)
                to[r] *= factor;
        }
    double *v = out + (long)nv * nv;
    product(WHOLE, nv, nv, nv, factor, X, nv, rates->A + nv, m, 0.0, NULL, v, nv);
    if (rates->damped)
        product(WHOLE, nv, nv, nv, factor, moved, nv, rates->A + (long)nv * m + nv, m, 1.0, v, v, nv);
}

/* The terms X_j dt^(j+1), and their number. */
static int set_terms(const Rates *rates, double dt, double *X)
{
    const int nv = rates->nv, length = nv * rates->m;
    const double enough = ROUNDING * dt * dt;
    memset(X, 0, sizeof *X * length);
    for (int i = 0; i < nv; i++)
        X[(long)(nv + i) * nv + i] = dt;
    int j = 1;
    for (; j < TERMS; j++) {
        double *next = X + (long)j * length, square = 0.0;
        advance(rates, dt / (j + 1), next - length, next);
        for (int i = 0; i < length; i++)
            square += next[i] * next[i];
        if (square <= enough * enough)
            return j + 1;
    }
    return j;
}

/* Columns of Z and of Z times their weights: W at the nodes, and what own noise of velocities drives. */
static int set_columns(const Rates *rates, int terms, int nodes, const double *rule, double dt, const double *X,
                       const double *at, const double *S, const double *own, double *Z, double *Y)
{
    const int nv = rates->nv, m = rates->m;
    for (int i = 0; i < nodes; i++) {
        double *z = Z + (long)i * nv * m;
        transposed(nv, m, at + (long)i * nv * m, nv, z);
        product(WHOLE, m, nv, nv, dt * rule[2 * i + 1], z, m, S, nv, 0.0, NULL, Y + (long)i * nv * m, m);
    }
    int columns = nodes * nv;
    for (int k = 0; k < nv; k++)
        for (int i = 0; own[k] > 0.0 && i < nodes; i++, columns++)
            for (int c = 0; c < m; c++) {
                double sum = 0.0, power = 1.0 / dt;
                for (int j = 0; j < terms; j++, power *= rule[2 * i])
                    sum += (j + 1) * power * X[(long)j * nv * m + (long)c * nv + k];
                Z[(long)columns * m + c] = sum;
                Y[(long)columns * m + c] = dt * rule[2 * i + 1] * own[k] * sum;
            }
    return columns;
}

/* E from its columns of v (transposed, V): A exp(A) = exp(A) A gives those of q. B: (m x m) to work in. */
static void set_motion(const Rates *rates, const double *V, double *B, double *E)
{
    const int nv = rates->nv, m = rates->m;
    double *back = B + (long)nv * m;
    transposed(nv, m, V, nv, E + (long)nv * m);
    advance(rates, 1.0, V, B);
    transposed(nv, m, B, nv, E);
    if (rates->damped) {
        memcpy(back, E + (long)nv * m, sizeof *back * nv * m);
        product(WHOLE, m, nv, nv, -1.0, back, m, rates->damping, nv, 1.0, E, E, m);
    }
}

/* M P M' + noise of (q, v), M = [E, G], and M P + cross with the forces; R: (m x N) to work in. */
static void propagate(int m, int nu, int N, const double *P, const double *M, const double *noise, const double *cross,
                      const double *D, double dt, double *R, double *after)
{
    product(WHOLE, m, N, N, 1.0, M, m, P, N, 0.0, NULL, R, m);
    for (int j = 0; j < m; j++)
        memcpy(after + (long)j * N + j, noise + (long)j * m + j, sizeof *after * (m - j));
    product(LOWER, m, m, N, 1.0, R, m, M, m, 1.0, after, after, N);
    for (int i = 0; i < m; i++)
        for (int k = 0; k < nu; k++)
            after[(long)i * N + m + k] = R[(long)(m + k) * m + i] + cross[(long)k * m + i];
    for (int k = 0; k < nu; k++)
        for (int l = k; l < nu; l++)
            after[(long)(m + k) * N + m + l] = P[(long)(m + k) * N + m + l] + dt * D[(long)k * nu + l];
    mirror(N, after);
}

/* Weights of the sums of X_j dt^(j+1): W, exp's columns of v, the integral of W; then W at the nodes. */
static void set_weights(int terms, int nodes, const double *rule, double dt, double *weights)
{
    const int count = SUMS + nodes;
    for (int j = 0; j < terms; j++) {
        double *w = weights + (long)j * count;
        w[0] = 1.0, w[1] = (j + 1) / dt, w[2] = dt / (j + 2);
        for (int i = 0; i < nodes; i++)
            w[SUMS + i] = j ? w[SUMS + i - count] * rule[2 * i] : rule[2 * i];
    }
}

int mbkf_exact_forces(int N, int m, int nv, int nu, int J, int most, const double *P, const double *A,
                      const double *by_u, const int *joints, double dt, const double *own, const double *forces,
                      const double *rules, double *motion, double *push, double *after)
{
    const long length = (long)nv * m, square = (long)m * m;
    int driven = nv;
    for (int k = 0; k < nv; k++)
        driven += own[k] > 0.0;
    const long room = (TERMS + SUMS + most) * length + 2L * m * most * driven + (SUMS + most) * TERMS + 2 * square +
                      2L * m * N + 2L * nv * nv + (long)nv * nu + 2L * m * nu;
    double *X = are_all_dofs(J, joints, nv) ? workspace(room) : NULL;
    if (!X)
        return 0;
    double *at = X + TERMS * length, *Z = at + (SUMS + most) * length, *Y = Z + (long)m * most * driven;
    double *weights = Y + (long)m * most * driven, *B = weights + (SUMS + most) * TERMS, *noise = B + square;
    double *M = noise + square, *R = M + (long)m * N, *S = R + (long)m * N, *damping = S + (long)nv * nv;
    double *pushed = damping + (long)nv * nv, *cross = pushed + (long)nv * nu, *turned = cross + (long)m * nu;
    Rates rates = {nv, m, J, 0, A, damping, joints};
    for (int i = 0; i < nv; i++)
        for (int j = 0; j < nv; j++) {
            damping[(long)j * nv + i] = A[(long)(nv + i) * m + nv + j];
            rates.damped = rates.damped || damping[(long)j * nv + i] != 0.0;
        }
    if (!(size_of(&rates, dt) <= LARGEST))
        return 0;
    const int terms = set_terms(&rates, dt, X), nodes = terms / 3 + 1 < most ? terms / 3 + 1 : most;
    const double *rule = rules + 2L * most * (nodes - 1);
    set_weights(terms, nodes, rule, dt, weights);
    product(WHOLE, (int)length, SUMS + nodes, terms, 1.0, X, (int)length, weights, SUMS + nodes, 0.0, NULL, at,
            (int)length);
    product(WHOLE, nv, nu, nu, 1.0, by_u, nv, forces, nu, 0.0, NULL, pushed, nv);
    product(WHOLE, nv, nv, nu, 1.0, pushed, nv, by_u, nv, 0.0, NULL, S, nv);
    const int columns = set_columns(&rates, terms, nodes, rule, dt, X, at + SUMS * length, S, own, Z, Y);
    product(LOWER, m, m, columns, 1.0, Y, m, Z, m, 0.0, NULL, noise, m);
    set_motion(&rates, at + length, B, motion);
    transposed(nv, m, at, nv, B);
    transposed(nv, nu, by_u, nv, turned);
    product(WHOLE, m, nu, nv, 1.0, B, m, turned, nu, 0.0, NULL, push, m);
    transposed(nv, m, at + 2 * length, nv, B);
    transposed(nv, nu, pushed, nv, turned);
    product(WHOLE, m, nu, nv, 1.0, B, m, turned, nu, 0.0, NULL, cross, m);
    memcpy(M, motion, sizeof *M * square);
    memcpy(M + square, push, sizeof *M * m * nu);
    propagate(m, nu, N, P, M, noise, cross, forces, dt, R, after);
    return terms;
}
