/* Prediction and update of a covariance P, which leave out products with zeros:
 *
 *     Phi P Phi' + Q                     Phi couples the dofs of one joint and is diagonal between q, v and a
 *     (P^-1 + L)^-1 = P - F F'           F = P G C^-T, L = G G', C C' = I + G' P G (Cholesky factors)
 *     P (l + H'y)
 *
 * as mbkf/filters/dynamic/plant.py and mbkf/numerics/information_update.py compute them with whole matrices. */
#include <string.h>

#include "bands.h"
#include "call.h"
#include "certain.h"
#include "factor.h"
#include "joints.h"
#include "product.h"
#include "symmetric.h"
#include "tree.h"
#include "vectorised.h"

/* out = A P + B S of one joint's rows, from first to end. */
VECTORISED static void joint_rows(int first, int end, int nv, int N, const double *A, const double *B,
                                  const double *P, const double *S, double *out)
{
    for (int i = first; i < end; i++) {
        double *o = out + (long)i * N;
        memset(o, 0, sizeof(double) * N);
        for (int k = first; k < end; k++) {
            const double a = A[i * nv + k], b = B[i * nv + k];
            const double *p = P + (long)k * N, *s = S + (long)k * N;
            if (a == 0.0 && b == 0.0)
                continue;
            for (int j = 0; j < N; j++)
                o[j] += a * p[j] + b * s[j];
        }
    }
}

/* after[q, q] = R_q A' + S_q B' of one joint's columns, in the rows that end on or above the diagonal. */
static void joint_columns(int first, int end, int nv, int N, const double *A, const double *B, const double *R,
                          const double *S, double *after)
{
    for (int i = 0; i < end; i++) {
        const double *r = R + (long)i * N, *s = S + (long)i * nv;
        for (int j = first; j < end; j++) {
            double sum = 0.0;
            for (int k = first; k < end; k++)
                sum += r[k] * A[j * nv + k] + s[k] * B[j * nv + k];
            after[(long)i * N + j] = sum;
        }
    }
}

/* The rows of q, v, a and the rest, from the diagonal of their blocks on; R are those of q times Phi_q'. */
VECTORISED static void other_columns(int nv, int N, const double *P, const Singer *s, const double *R,
                                     double *after)
{
    const double c1 = s->c1, rho = s->rho;
    const int v = nv, a = 2 * nv, rest = 3 * nv;
    for (int i = 0; i < nv; i++) {
        const double *r = R + (long)i * N;
        double *x = after + (long)i * N;
        for (int j = 0; j < nv; j++)
            x[v + j] = r[v + j] + c1 * r[a + j];
        for (int j = 0; j < nv; j++)
            x[a + j] = rho * r[a + j];
        memcpy(x + rest, r + rest, sizeof(double) * (N - rest));
    }
    for (int i = 0; i < nv; i++) {
        const double *p = P + (long)(v + i) * N, *d = P + (long)(a + i) * N;
        double *x = after + (long)(v + i) * N;
        for (int j = i; j < nv; j++)
            x[v + j] = p[v + j] + c1 * d[v + j] + c1 * (p[a + j] + c1 * d[a + j]);
        for (int j = 0; j < nv; j++)
            x[a + j] = rho * (p[a + j] + c1 * d[a + j]);
        for (int j = rest; j < N; j++)
            x[j] = p[j] + c1 * d[j];
    }
    for (int i = 0; i < nv; i++) {
        const double *d = P + (long)(a + i) * N;
        double *x = after + (long)(a + i) * N;
        for (int j = i; j < nv; j++)
            x[a + j] = rho * rho * d[a + j];
        for (int j = rest; j < N; j++)
            x[j] = rho * d[j];
    }
    for (int i = rest; i < N; i++)
        memcpy(after + (long)i * N + i, P + (long)i * N + i, sizeof(double) * (N - i));
}

/* S = dt P_v + c2 P_a, the rows that B multiplies; and the same of the columns of R. */
VECTORISED static void step_rows(int nv, int N, const double *P, const Singer *s, double *S)
{
    const double *v = P + (long)nv * N, *a = P + 2L * nv * N;
    for (long i = 0; i < (long)nv * N; i++)
        S[i] = s->dt_s * v[i] + s->c2 * a[i];
}

VECTORISED static void step_columns(int nv, int N, const double *R, const Singer *s, double *S)
{
    for (int i = 0; i < nv; i++) {
        const double *v = R + (long)i * N + nv, *a = R + (long)i * N + 2 * nv;
        for (int j = 0; j < nv; j++)
            S[(long)i * nv + j] = s->dt_s * v[j] + s->c2 * a[j];
    }
}

/* Adds diagonals of a number of blocks to the blocks on and above the diagonal, and copies these below. */
static void add_noise(int blocks, int nv, int N, const double *noise, const double *sd, double *after)
{
    for (int row = 0; row < blocks; row++)
        for (int column = row; column < blocks; column++)
            for (int i = 0; i < nv; i++)
                after[(long)(row * nv + i) * N + column * nv + i] +=
                    sd ? noise[blocks * row + column] * sd[i] * sd[i] : noise[(blocks * row + column) * nv + i];
    mirror(N, after);
}

static void propagate(int N, int nv, int J, const double *P, const double *A, const double *B, const int *joints,
                      const Singer *singer, const double *noise, const double *sd, double *after, double *work)
{
    double *S = work, *R = work + (long)nv * N;
    step_rows(nv, N, P, singer, S);
    for (int k = 0; k < J; k++)
        joint_rows(joints[2 * k], joints[2 * k + 1], nv, N, A, B, P, S, R);
    step_columns(nv, N, R, singer, S);
    for (int k = 0; k < J; k++)
        joint_columns(joints[2 * k], joints[2 * k + 1], nv, N, A, B, R, S, after);
    other_columns(nv, N, P, singer, R, after);
    add_noise(3, nv, N, noise, sd, after);
}

void mbkf_predict(int N, int J, int m, Tree *tree, const double *P, const double *q, const double *v, const double *a,
                  const int *joints, const Singer *singer, const double *noise, const double *sd, const double *walk,
                  double *P_after, double *q_after, double *v_after, double *a_after)
{
    const int nv = tree->nv;
    const long square = (long)nv * nv;
    double *step = are_all_dofs(J, joints, nv) ? workspace(nv + 2 * square + 2L * nv * N) : NULL;
    if (!step)
        return;
    for (int i = 0; i < nv; i++) {
        step[i] = singer->dt_s * v[i] + singer->c2 * a[i];
        v_after[i] = v[i] + singer->c1 * a[i];
        a_after[i] = singer->rho * a[i];
    }
    double *A = step + nv, *B = A + square;
    mbkf_integrate(tree, q, step, q_after);
    mbkf_integration_derivatives(tree, step, A, B);
    propagate(N, nv, J, P, A, B, joints, singer, noise, sd, P_after, B + square);
    for (int k = 0; k < m; k++)
        P_after[(long)(N - m + k) * (N + 1)] += walk[k];
}

void mbkf_propagate_velocities(int nv, int J, const double *P, const double *A, const double *B, const int *joints,
                               double dt, const double *noise, double *after)
{
    const int N = 2 * nv;
    double *S = are_all_dofs(J, joints, nv) ? workspace(2L * nv * N) : NULL;
    if (!S)
        return;
    double *R = S + (long)nv * N;
    for (long i = 0; i < (long)nv * N; i++)
        S[i] = dt * P[(long)nv * N + i];
    for (int k = 0; k < J; k++)
        joint_rows(joints[2 * k], joints[2 * k + 1], nv, N, A, B, P, S, R);
    for (int i = 0; i < nv; i++)
        for (int j = 0; j < nv; j++)
            S[(long)i * nv + j] = dt * R[(long)i * N + nv + j];
    for (int k = 0; k < J; k++)
        joint_columns(joints[2 * k], joints[2 * k + 1], nv, N, A, B, R, S, after);
    for (int i = 0; i < nv; i++) {
        memcpy(after + (long)i * N + nv, R + (long)i * N + nv, sizeof(double) * nv);
        memcpy(after + (long)(nv + i) * N + nv, P + (long)(nv + i) * N + nv, sizeof(double) * nv);
    }
    add_noise(2, nv, N, noise, NULL, after);
}

/* y (N) += a x */
VECTORISED static void plus(int N, double a, const double *x, double *y)
{
    for (int i = 0; i < N; i++)
        y[i] += a * x[i];
}

/* Rows of q and v of Phi P, R (2 nv x N); W: (nv x N) to work in. */
static void forced_rows(int N, int nv, int nu, int J, const double *P, const double *A, const double *B,
                        const double *U, const int *joints, double dt, double push, double *W, double *R)
{
    product(WHOLE, N, nv, nu, 1.0, P + 2L * nv * N, N, U, nv, 0.0, NULL, W, N);
    for (int k = 0; k < J; k++)
        joint_rows(joints[2 * k], joints[2 * k + 1], nv, N, A, B, P, P + (long)nv * N, R);
    if (push != 0.0)
        plus(nv * N, push, W, R);
    memcpy(R + (long)nv * N, P + (long)nv * N, sizeof *R * nv * N);
    plus(nv * N, dt, W, R + (long)nv * N);
}

/* Noise of forces that last: Q of thesis eq. 2.45 in v and u; Y: (nv x nu) and Z: (nv x nv) to work in. */
static void add_forces(int N, int nv, int nu, const double *U, const double *D, double dt, double *Y, double *Z,
                       double *after)
{
    product(WHOLE, nv, nu, nu, 1.0, U, nv, D, nu, 0.0, NULL, Y, nv);
    product(WHOLE, nv, nv, nu, dt * dt * dt / 3.0, Y, nv, U, nv, 0.0, NULL, Z, nv);
    for (int i = 0; i < nv; i++) {
        double *row = after + (long)(nv + i) * N + nv;
        plus(nv, 1.0, Z + (long)i * nv, row);
        for (int k = 0; k < nu; k++)
            row[nv + k] += 0.5 * dt * dt * Y[(long)k * nv + i];
    }
    for (int k = 0; k < nu; k++)
        plus(nu, dt, D + (long)k * nu, after + (long)(2 * nv + k) * N + 2 * nv);
}

void mbkf_propagate_forces(int N, int nv, int nu, int J, const double *P, const double *A, const double *B,
                           const double *by_u, const int *joints, double dt, double push, const double *own,
                           const double *forces, double *after)
{
    const int both = 2 * nv;
    double *W = are_all_dofs(J, joints, nv) ? workspace(3L * nv * N + 3L * nv * nv + 2L * nv * nu) : NULL;
    if (!W)
        return;
    double *R = W + (long)nv * N, *V = R + 2L * nv * N, *Y = V + 2L * nv * nv, *Z = Y + 2L * nv * nu;
    forced_rows(N, nv, nu, J, P, A, B, by_u, joints, dt, push, W, R);
    /* Columns of v gain dt V, V = R_u U' (2 nv x nv, row by row), those of q push V. */
    transposed(nu, both, R + both, N, Y);
    product(WHOLE, nv, both, nu, 1.0, by_u, nv, Y, both, 0.0, NULL, V, nv);
    for (int i = 0; i < nv; i++)
        memcpy(W + (long)i * nv, R + (long)i * N + nv, sizeof *W * nv);
    for (int k = 0; k < J; k++)
        joint_columns(joints[2 * k], joints[2 * k + 1], nv, N, A, B, R, W, after);
    for (int i = 0; i < both; i++) {
        double *to = after + (long)i * N;
        memcpy(to + nv, R + (long)i * N + nv, sizeof *to * (N - nv));
        plus(nv, dt, V + (long)i * nv, to + nv);
        if (i < nv && push != 0.0)
            plus(nv, push, V + (long)i * nv, to);
    }
    for (int k = both; k < N; k++)
        memcpy(after + (long)k * N + both, P + (long)k * N + both, sizeof *after * nu);
    for (int i = 0; i < nv; i++) {
        after[(long)i * (N + 1)] += own[i] * dt * dt * dt / 3.0;
        after[(long)i * (N + 1) + nv] += own[i] * dt * dt / 2.0;
        after[(long)(nv + i) * (N + 1)] += own[i] * dt;
    }
    add_forces(N, nv, nu, by_u, forces, dt, Y, Z, after);
    mirror(N, after);
}

/* G with G G' = L: upper triangular, as the Cholesky factor of L in reverse order is; rows and columns of components
 * without information are zero. */
static int square_root(int n, const double *L, double *G)
{
    const long last = (long)n * n - 1;
    for (long i = 0; i <= last; i++)
        G[i] = L[last - i];
    for (int i = 0; i < n; i++)
        if (G[(long)i * (n + 1)] == 0.0)
            G[(long)i * (n + 1)] = 1.0;
    if (factored(n, G))
        return 1;
    for (long i = 0; i < (last + 1) / 2; i++) {
        const double kept = G[i];
        G[i] = G[last - i];
        G[last - i] = kept;
    }
    for (int i = 0; i < n; i++)
        if (L[(long)i * (n + 1)] == 0.0)
            for (int j = i; j < n; j++)
                G[(long)j * n + i] = 0.0;
    return 0;
}

/* W C^-T with C C' = I + S in place of W (N x m); S (m x m) is overwritten. */
static int half(int N, int m, double *W, double *S)
{
    for (int i = 0; i < m; i++)
        S[(long)i * m + i] += 1.0;
    if (factored(m, S))
        return 1;
    divided(N, m, S, W);
    return 0;
}

/* C (rows x n) = A K of an upper triangular K (n x n); across is K'. */
static void by_triangle(int rows, int n, const double *A, int lda, const double *across, double *C)
{
    enum { BREADTH = 8 }; /* columns of K whose trailing zeros are left out together */
    for (int b = 0; b < n; b += BREADTH) {
        const int columns = n - b < BREADTH ? n - b : BREADTH;
        product(WHOLE, rows, columns, b + columns, 1.0, A, lda, across + b, n, 0.0, NULL, C + (long)b * rows, rows);
    }
}

/* S = G' P G of an upper triangular G (n x n), the part on and below its diagonal; across is G', T: (n x n) to work in. */
static void squeezed(int n, const double *across, const double *P, int N, double *T, double *S)
{
    enum { HEIGHT = 24 }; /* rows of G' whose trailing zeros are left out together */
    for (int b = 0; b < n; b += HEIGHT) {
        const int rows = n - b < HEIGHT ? n - b : HEIGHT;
        product(WHOLE, rows, n, b + rows, 1.0, across + b, n, P, N, 0.0, NULL, T + b, n);
    }
    for (int b = 0; b < n; b += HEIGHT) {
        const int columns = n - b < HEIGHT ? n - b : HEIGHT;
        product(LOWER, n - b, columns, b + columns, 1.0, T + b, n, across + b, n, 0.0, NULL, S + (long)b * n + b, n);
    }
}

/* The second half of the reduction: W = (P - F F') rows' C^-T with C C' = rows (P - F F') rows' + I, where F = P K,
 * across is K'. Y: (m x n), Q: (m x m) and V: (m x N) to work in; R: (N x m), rows column by column. */
static int reduced_by_rows(int N, const double *P, int n, const double *across, const double *F, int m,
                           const double *rows, double *W, double *Y, double *Q, double *R, double *V)
{
    transposed(N, m, rows, N, R);
    for (Band b = {0, 0, 0, 0}; b.end < m;) {
        b = band_from(b.end, m, N, rows);
        product(WHOLE, N, b.end - b.start, b.last - b.first, 1.0, P + (long)b.first * N, N,
                R + (long)b.first * m + b.start, m, 0.0, NULL, W + (long)b.start * N, N);
    }
    transposed(n, m, W, N, V);
    by_triangle(m, n, V, m, across, Y);
    product(WHOLE, N, m, n, -1.0, F, N, Y, m, 1.0, W, W, N);
    transposed(N, m, W, N, V);
    for (Band b = {0, 0, 0, 0}; b.end < m;) {
        b = band_from(b.end, m, N, rows);
        product(WHOLE, b.end - b.start, m, b.last - b.first, 1.0, R + (long)b.first * m + b.start, m,
                V + (long)b.first * m, m, 0.0, NULL, Q + b.start, m);
    }
    return half(N, m, W, Q);
}

/* Numbers that `informed` works in. */
static long room(long N, long n, long m) { return N * (n + m) + 4 * n * n + m * (n + m + 2 * N); }

/* As mbkf_add_information, working in F. */
static int informed(int N, int n, int m, const double *P, const double *information, const double *rows,
                    double *after, double *F)
{
    double *W = F + (long)N * n, *G = W + (long)N * m, *across = G + (long)n * n;
    double *T = across + (long)n * n, *S = T + (long)n * n, *Y = S + (long)n * n, *Q = Y + (long)m * n;
    double *R = Q + (long)m * m;
    if (square_root(n, information, G))
        return 1;
    transposed(n, n, G, n, across);
    squeezed(n, across, P, N, T, S);
    if (half(n, n, G, S))
        return 2;
    transposed(n, n, G, n, across);
    by_triangle(N, n, P, N, across, F);
    if (m && reduced_by_rows(N, P, n, across, F, m, rows, W, Y, Q, R, R + (long)m * N))
        return 3;
    product(LOWER, N, N, n + m, -1.0, F, N, F, N, 1.0, P, after, N);
    mirror(N, after);
    return 0;
}

int mbkf_add_information(int N, int n, int m, const double *P, const double *information, const double *rows,
                         double *after)
{
    const long square = (long)N * N;
    double *F = workspace(room(N, n, m) + 2 * square + (long)n * n + (long)m * N + N);
    if (!F)
        return 0;
    double *own = F + room(N, n, m), *found = own + square, *first = found + square, *others = first + (long)n * n;
    int *known = (int *)(others + (long)m * N), count = uncertain(N, P, NULL, known), ahead = 0;
    while (ahead < count && known[ahead] < n)
        ahead++;
    if (count == N || !ahead)
        return informed(N, n, m, P, information, rows, after, F);
    pick(count, known, count, known, N, P, own);
    pick(ahead, known, ahead, known, n, information, first);
    pick(m, NULL, count, known, N, rows, others);
    const int failed = informed(count, ahead, m, own, first, others, found, F);
    if (failed)
        return failed;
    put(count, known, found, N, after);
    return 0;
}

void mbkf_correction(int N, int n, int m, const double *P, const double *vector, const double *rows,
                     const double *values, double *step)
{
    double *total = workspace(N);
    if (!total)
        return;
    memset(total, 0, sizeof *total * N);
    memcpy(total, vector, sizeof *total * n);
    memset(step, 0, sizeof *step * N);
    for (int k = 0; k < m; k++)
        if (values[k] != 0.0)
            plus(N, values[k], rows + (long)k * N, total);
    for (int k = 0; k < N; k++)
        plus(N, total[k], P + (long)k * N, step);
}
