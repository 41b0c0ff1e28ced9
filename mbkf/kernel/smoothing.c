/* Backward pass of a smoother in its gradient and curvature L, as mbkf/numerics/smoothing.py computes them with whole
 * matrices. Products with zeros are left out: a transition couples a joint's dofs alone, readings are of the first components and of a few
 * rows, whose columns are bands (bands.h). */
#include <string.h>

#include "bands.h"
#include "call.h"
#include "certain.h"
#include "declared.h"
#include "joints.h"
#include "product.h"
#include "symmetric.h"
#include "vectorised.h"

/* Phi of mbkf/numerics/rate_transition.py: A, B (nv x nv), joints (J x 2), push (orders), rates (orders x orders). */
typedef struct {
    int nv, orders, J;
    const double *A, *B, *push, *rates;
    const int *joints;
} Transition;

/* Rows of one joint: of A' L to `out`, of B' L to `pushed`. */
VECTORISED static void joint_rows_before(int first, int end, int N, const Transition *phi, const double *L, double *out,
                                         double *pushed)
{
    for (int i = first; i < end; i++) {
        double *o = out + (long)i * N, *p = pushed + (long)i * N;
        memset(o, 0, sizeof(double) * N);
        memset(p, 0, sizeof(double) * N);
        for (int k = first; k < end; k++) {
            const double a = phi->A[k * phi->nv + i], b = phi->B[k * phi->nv + i];
            const double *l = L + (long)k * N;
            for (int j = 0; j < N; j++) {
                o[j] += a * l[j];
                p[j] += b * l[j];
            }
        }
    }
}

/* out = Phi' L, row by row. */
VECTORISED static void rows_before(int N, const double *L, const Transition *phi, double *out, double *pushed)
{
    const int nv = phi->nv, orders = phi->orders;
    const long rest = (long)(1 + orders) * nv * N;
    for (int k = 0; k < phi->J; k++)
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

void mbkf_curvature_before_motion(int N, int nv, int J, int orders, const double *L, const double *A, const double *B,
                                  const int *joints, const double *push, const double *rates, double *before)
{
    const Transition phi = {nv, orders, J, A, B, push, rates, joints};
    double *turned = are_all_dofs(J, joints, nv) ? workspace((long)N * (N + nv)) : NULL;
    if (!turned)
        return;
    double *pushed = turned + (long)N * N;
    rows_before(N, L, &phi, before, pushed);
    transpose(N, before, turned);
    rows_before(N, turned, &phi, before, pushed);
}

/* step -= P gradient and change += P kept, both in one way through P, four of its columns at once. */
VECTORISED static void both_products(int N, const double *P, const double *gradient, const double *kept,
                                     double *restrict step, double *restrict change)
{
    int k = 0;
    for (; k + 4 <= N; k += 4) {
        const double *p = P + (long)k * N;
        const double g0 = gradient[k], g1 = gradient[k + 1], g2 = gradient[k + 2], g3 = gradient[k + 3];
        const double h0 = kept[k], h1 = kept[k + 1], h2 = kept[k + 2], h3 = kept[k + 3];
        for (int i = 0; i < N; i++) {
            const double a = p[i], b = p[N + i], c = p[2 * N + i], d = p[3 * N + i];
            step[i] -= g0 * a + g1 * b + (g2 * c + g3 * d);
            change[i] += h0 * a + h1 * b + (h2 * c + h3 * d);
        }
    }
    for (; k < N; k++)
        for (int i = 0; i < N; i++) {
            step[i] -= gradient[k] * P[(long)k * N + i];
            change[i] += kept[k] * P[(long)k * N + i];
        }
}

/* out -= rows' rows x, rows (m x N). */
VECTORISED static void without_rows(int N, int m, const double *rows, const double *x,
                                    double *restrict out)
{
    for (int j = 0; j < m; j++, rows += N) {
        double sum = 0.0;
        for (int i = 0; i < N; i++)
            sum += rows[i] * x[i];
        for (int i = 0; i < N; i++)
            out[i] -= sum * rows[i];
    }
}

/* before = Phi' gradient */
static void gradient_before_motion(int N, const Transition *phi, const double *gradient, double *before)
{
    const int nv = phi->nv, orders = phi->orders;
    double *rates = before + nv;
    memcpy(before, gradient, sizeof(double) * N);
    memset(before, 0, sizeof(double) * (1 + orders) * nv);
    for (int one = 0; one < phi->J; one++)
        for (int i = phi->joints[2 * one]; i < phi->joints[2 * one + 1]; i++) {
            double pushed = 0.0;
            for (int k = phi->joints[2 * one]; k < phi->joints[2 * one + 1]; k++) {
                before[i] += phi->A[k * nv + i] * gradient[k];
                pushed += phi->B[k * nv + i] * gradient[k];
            }
            for (int order = 0; order < orders; order++)
                rates[order * nv + i] = phi->push[order] * pushed;
        }
    for (int order = 0; order < orders; order++)
        for (int of = 0; of < orders; of++)
            for (int i = 0; i < nv; i++)
                rates[order * nv + i] += phi->rates[of * orders + order] * gradient[(1 + of) * nv + i];
}

void mbkf_gradient_before(int N, int n, int m, int nv, int J, int orders, const double *P, const double *gradient,
                          const double *vector, const double *information, const double *rows, const double *A,
                          const double *B, const int *joints, const double *push, const double *rates, double *step,
                          double *before)
{
    const Transition phi = {nv, orders, J, A, B, push, rates, joints};
    double *kept = are_all_dofs(J, joints, nv) ? workspace(2L * N) : NULL;
    if (!kept)
        return;
    double *change = kept + N;
    for (int i = 0; i < N; i++)
        kept[i] = gradient[i] - vector[i];
    memset(step, 0, sizeof *step * N);
    memset(change, 0, sizeof *change * N);
    both_products(N, P, gradient, kept, step, change);
    without_rows(N, m, rows, change, kept);
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++)
            kept[i] -= change[j] * information[(long)j * n + i];
    gradient_before_motion(N, &phi, kept, before);
}

/* Column by column, P L row by row is L P. */
static void smoothed_and_product(int N, const double *P, const double *L, double *smoothed, double *PL, double *turned)
{
    product(WHOLE, N, N, N, 1.0, L, N, P, N, 0.0, NULL, PL, N);
    transpose(N, PL, turned);
    product(LOWER, N, N, N, -1.0, P, N, turned, N, 1.0, P, smoothed, N);
    mirror(N, smoothed);
}

void mbkf_smoothed_covariance(int N, const double *P, const double *L, double *smoothed, double *PL)
{
    const long square = (long)N * N;
    double *turned = workspace(5 * square + N);
    if (!turned)
        return;
    double *own = turned + square, *later = own + square, *found = later + square, *both = found + square;
    int *known = (int *)(both + square), count = uncertain(N, P, NULL, known);
    if (count == N) {
        smoothed_and_product(N, P, L, smoothed, PL, turned);
        return;
    }
    pick(count, known, count, known, N, P, own);
    pick(count, known, count, known, N, L, later);
    smoothed_and_product(count, own, later, found, both, turned);
    put(count, known, found, N, smoothed);
    put(count, known, both, N, PL);
}

/* Z = L P + M smoothed / 2 (column by column); R: rows' transpose; S: (N x m), working memory. */
static void half_before(int N, const double *smoothed, const double *LP, int n, const double *information, int m,
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

/* As mbkf_curvature_before_readings, working in Z. */
static void before_readings(int N, int n, int m, const double *L, const double *smoothed, const double *PL,
                            const double *information, const double *rows, double *before, double *Z)
{
    double *R = Z + (long)N * N, *S = R + (long)N * m;
    transposed(N, m, rows, N, R);
    half_before(N, smoothed, PL, n, information, m, rows, R, S, Z);
    /* Half of the sum; its transpose is added at the end. */
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

/* Curvature in components that are certain counts nowhere, and is left out. */
void mbkf_curvature_before_readings(int N, int n, int m, const double *L, const double *smoothed, const double *PL,
                                    const double *information, const double *rows, double *before)
{
    const long square = (long)N * N;
    double *Z = workspace(5 * square + 3L * m * N + (long)n * n + N);
    if (!Z)
        return;
    double *later = Z + square + 2L * m * N, *own = later + square, *both = own + square, *found = both + square;
    double *first = found + square, *others = first + (long)n * n;
    int *known = (int *)(others + (long)m * N), count = uncertain(N, smoothed, PL, known), ahead = 0;
    while (ahead < count && known[ahead] < n)
        ahead++;
    if (count == N) {
        before_readings(N, n, m, L, smoothed, PL, information, rows, before, Z);
        return;
    }
    pick(count, known, count, known, N, L, later);
    pick(count, known, count, known, N, smoothed, own);
    pick(count, known, count, known, N, PL, both);
    pick(ahead, known, ahead, known, n, information, first);
    pick(m, NULL, count, known, N, rows, others);
    before_readings(count, ahead, m, later, own, both, first, others, found, Z);
    put(count, known, found, N, before);
}
