/* The backward pass as mbkf/numerics/smoothing.py states it, in products that leave out what is zero: a transition
 * couples a joint's dofs alone, readings tell of the first components and of a few rows. */
#include "smoothing.h"

#include <string.h>

#include "bands.h"
#include "product.h"
#include "symmetric.h"
#include "vectorised.h"

/* The rows of one joint: of A' L to `carried`, of B' L to `pushed`. */
VECTORISED static void joint_rows_before(int first, int dofs, int N, const Rates *phi, const double *L, double *carried,
                                         double *pushed)
{
    for (int i = first; i < first + dofs; i++) {
        double *c = carried + (long)i * N, *p = pushed + (long)i * N;
        memset(c, 0, sizeof(double) * N);
        memset(p, 0, sizeof(double) * N);
        for (int k = first; k < first + dofs; k++) {
            const double a = phi->A[k * phi->nv + i], b = phi->B[k * phi->nv + i];
            const double *l = L + (long)k * N;
            for (int j = 0; j < N; j++) {
                c[j] += a * l[j];
                p[j] += b * l[j];
            }
        }
    }
}

/* out = Phi' L, row by row. */
VECTORISED static void rows_before(int N, const double *L, const Rates *phi, double *out, double *pushed)
{
    const int nv = phi->nv, orders = phi->orders;
    const long rest = (long)(1 + orders) * nv * N;
    for (int k = 0; k < phi->n_joints; k++)
        joint_rows_before(phi->joints[2 * k], phi->joints[2 * k + 1], N, phi, L, out, pushed);
    for (int order = 0; order < orders; order++) {
        double *o = out + (long)(1 + order) * nv * N;
        for (long i = 0; i < (long)nv * N; i++)
            o[i] = phi->push[order] * pushed[i];
        for (int of = 0; of < orders; of++) {
            const double rate = phi->rates[of * orders + order];
            const double *l = L + (long)(1 + of) * nv * N;
            if (rate != 0.0)
                for (long i = 0; i < (long)nv * N; i++)
                    o[i] += rate * l[i];
        }
    }
    memcpy(out + rest, L + rest, sizeof(double) * ((long)N * N - rest));
}

long motion_work(int N, int nv) { return (long)N * (N + nv); }

void curvature_before_motion(int N, const double *L, const Rates *phi, double *before, double *work)
{
    rows_before(N, L, phi, before, work + (long)N * N);
    transpose(N, before, work);
    rows_before(N, work, phi, before, work + (long)N * N);
}

void smoothed_covariance(int N, const double *P, const double *L, double *smoothed, double *LP, double *work)
{
    product(WHOLE, N, N, N, 1.0, L, N, P, N, 0.0, NULL, LP, N);
    transpose(N, LP, work);
    product(LOWER, N, N, N, -1.0, P, N, work, N, 1.0, P, smoothed, N);
    mirror(N, smoothed);
}

/* Z = L P + M smoothed / 2 (column by column); R: rows' transpose; S: (N x m) to work in. */
static void half_told(int N, const double *smoothed, const double *LP, int n, const double *information, int m,
                      const double *rows, const double *R, double *S, double *Z)
{
    memcpy(Z, LP, sizeof(double) * N * N);
    product(WHOLE, n, N, n, 0.5, information, n, smoothed, N, 1.0, Z, Z, N);
    for (Band b = {0, 0, 0, 0}; b.end < m;) {
        b = band_from(b.end, m, N, rows);
        const int count = b.end - b.start, width = b.last - b.first;
        double *s = S + (long)b.start * N;
        product(WHOLE, N, count, width, 1.0, smoothed + (long)b.first * N, N, R + (long)b.first * m + b.start, m, 0.0,
                NULL, s, N);
        product(WHOLE, width, N, count, 0.5, rows + (long)b.start * N + b.first, N, s, N, 1.0, Z + b.first,
                Z + b.first, N);
    }
}

long readings_work(int N, int m) { return (long)N * (N + 2L * m); }

void curvature_before_readings(int N, const double *L, const double *smoothed, const double *LP, int n,
                               const double *information, int m, const double *rows, double *before, double *work)
{
    double *Z = work, *R = Z + (long)N * N, *S = R + (long)N * m;
    transposed(N, m, rows, N, R);
    half_told(N, smoothed, LP, n, information, m, rows, R, S, Z);
    /* Half of the sum, whose transpose is added at the end. */
    product(WHOLE, N, n, n, -1.0, Z, N, information, n, 0.5, L, before, N);
    for (long i = (long)n * N; i < (long)N * N; i++)
        before[i] = 0.5 * L[i];
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++)
            before[(long)j * N + i] += 0.5 * information[(long)j * n + i];
    for (Band b = {0, 0, 0, 0}; b.end < m;) {
        b = band_from(b.end, m, N, rows);
        const int count = b.end - b.start, width = b.last - b.first;
        const double *r = rows + (long)b.start * N;
        double *s = S + (long)b.start * N;
        product(WHOLE, N, count, width, 1.0, Z + (long)b.first * N, N, R + (long)b.first * m + b.start, m, -0.5, r, s,
                N);
        product(WHOLE, N, width, count, -1.0, s, N, r + b.first, N, 1.0, before + (long)b.first * N,
                before + (long)b.first * N, N);
    }
    symmetrise(N, before);
}
