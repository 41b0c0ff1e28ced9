/* Prediction and update of a covariance, as mbkf/filters/dynamic/plant.py and
 * mbkf/numerics/information_update.py state them. Products of whole matrices are BLAS's. */
#include "covariance.h"

#include <string.h>

#include "bands.h"
#include "blas.h"
#include "factor.h"
#include "product.h"
#include "symmetric.h"
#include "vectorised.h"

/* out = A P + B S of one joint's rows, from first on, for all columns. */
VECTORISED static void joint_rows(int first, int dofs, int nv, int N, const double *A, const double *B,
                                  const double *P, const double *S, double *out)
{
    for (int i = first; i < first + dofs; i++) {
        double *o = out + (long)i * N;
        memset(o, 0, sizeof(double) * N);
        for (int k = first; k < first + dofs; k++) {
            const double a = A[i * nv + k], b = B[i * nv + k];
            const double *p = P + (long)k * N, *s = S + (long)k * N;
            if (a == 0.0 && b == 0.0)
                continue;
            for (int j = 0; j < N; j++)
                o[j] += a * p[j] + b * s[j];
        }
    }
}

/* carried[q, q] = R_q A' + S_q B' of one joint's columns, in the rows that end on or above the diagonal. */
static void joint_columns(int first, int dofs, int nv, int N, const double *A, const double *B, const double *R,
                          const double *S, double *carried)
{
    for (int i = 0; i < first + dofs; i++) {
        const double *r = R + (long)i * N, *s = S + (long)i * nv;
        for (int j = first; j < first + dofs; j++) {
            double sum = 0.0;
            for (int k = first; k < first + dofs; k++)
                sum += r[k] * A[j * nv + k] + s[k] * B[j * nv + k];
            carried[(long)i * N + j] = sum;
        }
    }
}

/* The rows of q, v, a and the rest, from the diagonal of their blocks on; R are those of q times Phi_q'. */
VECTORISED static void other_columns(int nv, int N, const double *P, const Singer *s, const double *R,
                                     double *carried)
{
    const double c1 = s->c1, rho = s->rho;
    const int v = nv, a = 2 * nv, rest = 3 * nv;
    for (int i = 0; i < nv; i++) {
        const double *r = R + (long)i * N;
        double *x = carried + (long)i * N;
        for (int j = 0; j < nv; j++)
            x[v + j] = r[v + j] + c1 * r[a + j];
        for (int j = 0; j < nv; j++)
            x[a + j] = rho * r[a + j];
        memcpy(x + rest, r + rest, sizeof(double) * (N - rest));
    }
    for (int i = 0; i < nv; i++) {
        const double *p = P + (long)(v + i) * N, *d = P + (long)(a + i) * N;
        double *x = carried + (long)(v + i) * N;
        for (int j = i; j < nv; j++)
            x[v + j] = p[v + j] + c1 * d[v + j] + c1 * (p[a + j] + c1 * d[a + j]);
        for (int j = 0; j < nv; j++)
            x[a + j] = rho * (p[a + j] + c1 * d[a + j]);
        for (int j = rest; j < N; j++)
            x[j] = p[j] + c1 * d[j];
    }
    for (int i = 0; i < nv; i++) {
        const double *d = P + (long)(a + i) * N;
        double *x = carried + (long)(a + i) * N;
        for (int j = i; j < nv; j++)
            x[a + j] = rho * rho * d[a + j];
        for (int j = rest; j < N; j++)
            x[j] = rho * d[j];
    }
    for (int i = rest; i < N; i++)
        memcpy(carried + (long)i * N + i, P + (long)i * N + i, sizeof(double) * (N - i));
}

/* S = dt P_v + c2 P_a, the rows that B multiplies; and the same of the columns of R. */
VECTORISED static void pushed_rows(int nv, int N, const double *P, const Singer *s, double *S)
{
    const double *v = P + (long)nv * N, *a = P + 2L * nv * N;
    for (long i = 0; i < (long)nv * N; i++)
        S[i] = s->dt * v[i] + s->c2 * a[i];
}

VECTORISED static void pushed_columns(int nv, int N, const double *R, const Singer *s, double *S)
{
    for (int i = 0; i < nv; i++) {
        const double *v = R + (long)i * N + nv, *a = R + (long)i * N + 2 * nv;
        for (int j = 0; j < nv; j++)
            S[(long)i * nv + j] = s->dt * v[j] + s->c2 * a[j];
    }
}

long carry_work(int nv, int N) { return 2L * nv * N; }

void carry(int nv, int N, const double *P, const double *A, const double *B, const int *joints, int n_joints,
           const Singer *singer, const double *noise, const double *sd, double *carried, double *work)
{
    double *S = work, *R = work + (long)nv * N;
    pushed_rows(nv, N, P, singer, S);
    for (int k = 0; k < n_joints; k++)
        joint_rows(joints[2 * k], joints[2 * k + 1], nv, N, A, B, P, S, R);
    pushed_columns(nv, N, R, singer, S);
    for (int k = 0; k < n_joints; k++)
        joint_columns(joints[2 * k], joints[2 * k + 1], nv, N, A, B, R, S, carried);
    other_columns(nv, N, P, singer, R, carried);
    for (int row = 0; row < 3; row++)
        for (int column = row; column < 3; column++)
            for (int i = 0; i < nv; i++)
                carried[(long)(row * nv + i) * N + column * nv + i] += noise[3 * row + column] * sd[i] * sd[i];
    mirror(N, carried);
}

void carry_velocities(int nv, const double *P, const double *A, const double *B, const int *joints, int n_joints,
                      double dt, const double *noise, double *carried, double *work)
{
    const int N = 2 * nv;
    double *S = work, *R = work + (long)nv * N;
    for (long i = 0; i < (long)nv * N; i++)
        S[i] = dt * P[(long)nv * N + i];
    for (int k = 0; k < n_joints; k++)
        joint_rows(joints[2 * k], joints[2 * k + 1], nv, N, A, B, P, S, R);
    for (int i = 0; i < nv; i++)
        for (int j = 0; j < nv; j++)
            S[(long)i * nv + j] = dt * R[(long)i * N + nv + j];
    for (int k = 0; k < n_joints; k++)
        joint_columns(joints[2 * k], joints[2 * k + 1], nv, N, A, B, R, S, carried);
    for (int i = 0; i < nv; i++) {
        memcpy(carried + (long)i * N + nv, R + (long)i * N + nv, sizeof(double) * nv);
        memcpy(carried + (long)(nv + i) * N + nv, P + (long)(nv + i) * N + nv, sizeof(double) * nv);
    }
    for (int row = 0; row < 2; row++)
        for (int column = row; column < 2; column++)
            for (int i = 0; i < nv; i++)
                carried[(long)(row * nv + i) * N + column * nv + i] += noise[(2 * row + column) * nv + i];
    mirror(N, carried);
}

/* G with G G' = L: lower Cholesky factor; components that nothing informs about are set aside. */
static int square_root(int n, const double *L, double *G)
{
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++)
            G[(long)j * n + i] = i < j ? 0.0 : L[(long)j * n + i];
    for (int i = 0; i < n; i++)
        if (L[(long)i * n + i] == 0.0)
            G[(long)i * n + i] = 1.0;
    if (factored(n, G))
        return 1;
    for (int i = 0; i < n; i++)
        if (L[(long)i * n + i] == 0.0)
            for (int j = 0; j <= i; j++)
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

/* The second half of the reduction: W = (P - F F') rows' C^-T with C C' = rows (P - F F') rows' + I, where F = P K.
 * Y: (m x n) and Q: (m x m) to work in; R: (N x m), rows column by column. */
static int reduced_by_rows(int N, const double *P, int n, const double *K, const double *F, int m,
                           const double *rows, double *W, double *Y, double *Q, double *R)
{
    double one = 1.0, zero = 0.0;
    transposed(N, m, rows, N, R);
    for (Band b = {0, 0, 0, 0}; b.end < m;) {
        b = band_from(b.end, m, N, rows);
        product(WHOLE, N, b.end - b.start, b.last - b.first, 1.0, P + (long)b.first * N, N,
                R + (long)b.first * m + b.start, m, 0.0, NULL, W + (long)b.start * N, N);
    }
    blas.dgemm("t", "n", &m, &n, &n, &one, W, &N, (double *)K, &n, &zero, Y, &m);
    product(WHOLE, N, m, n, -1.0, F, N, Y, m, 1.0, W, W, N);
    for (Band b = {0, 0, 0, 0}; b.end < m;) {
        b = band_from(b.end, m, N, rows);
        int count = b.end - b.start, width = b.last - b.first;
        blas.dgemm("t", "n", &count, &m, &width, &one, (double *)rows + (long)b.start * N + b.first, &N,
                   W + b.first, &N, &zero, Q + b.start, &m);
    }
    return half(N, m, W, Q);
}

long inform_work(int n, int m, int N)
{
    return (long)N * (n + m) + 4L * n * n + (long)m * (n + m + N);
}

int inform(int N, const double *P, int n, const double *information, int m, const double *rows, double *informed,
           double *work)
{
    double *F = work, *W = F + (long)N * n, *G = W + (long)N * m, *across = G + (long)n * n;
    double *T = across + (long)n * n, *S = T + (long)n * n, *Y = S + (long)n * n, *Q = Y + (long)m * n;
    if (square_root(n, information, G))
        return 1;
    transposed(n, n, G, n, across);
    product(WHOLE, n, n, n, 1.0, across, n, P, N, 0.0, NULL, T, n);
    product(LOWER, n, n, n, 1.0, T, n, across, n, 0.0, NULL, S, n);
    if (half(n, n, G, S))
        return 2;
    transposed(n, n, G, n, across);
    product(WHOLE, N, n, n, 1.0, P, N, across, n, 0.0, NULL, F, N);
    if (m && reduced_by_rows(N, P, n, G, F, m, rows, W, Y, Q, Q + (long)m * m))
        return 3;
    product(LOWER, N, N, n + m, -1.0, F, N, F, N, 1.0, P, informed, N);
    mirror(N, informed);
    return 0;
}

/* y (N) += a x */
VECTORISED static void plus(int N, double a, const double *x, double *y)
{
    for (int i = 0; i < N; i++)
        y[i] += a * x[i];
}

void correction(int N, const double *P, int n, const double *vector, int m, const double *rows, const double *values,
                double *step, double *total)
{
    memset(total, 0, sizeof *total * N);
    memcpy(total, vector, sizeof *total * n);
    memset(step, 0, sizeof *step * N);
    for (int k = 0; k < m; k++)
        if (values[k] != 0.0)
            plus(N, values[k], rows + (long)k * N, total);
    for (int k = 0; k < N; k++)
        plus(N, total[k], P + (long)k * N, step);
}
