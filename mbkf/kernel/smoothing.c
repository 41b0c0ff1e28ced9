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
#include "transition.h"
#include "vectorised.h"

void mbkf_curvature_before_motion(int N, int nv, int J, int orders, const double *L, const double *A, const double *B,
                                  const int *joints, const double *push, const double *rates, double *before)
{
    const Transition phi = {nv, orders, J, A, B, push, rates, joints};
    double *turned = are_all_dofs(J, joints, nv) ? workspace((long)N * N) : NULL;
    if (!turned)
        return;
    rows_before(N, L, &phi, before);
    transposed(N, N, before, N, turned);
    rows_before(N, turned, &phi, before);
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
    vector_before(N, &phi, kept, before);
}

static void smoothed_and_product(int N, const double *P, const double *L, double *smoothed, double *LP, double *turned)
{
    product(WHOLE, N, N, N, 1.0, L, N, P, N, 0.0, NULL, LP, N);
    transposed(N, N, LP, N, turned);
    product(LOWER, N, N, N, -1.0, P, N, turned, N, 1.0, P, smoothed, N);
    mirror(N, smoothed);
}

void mbkf_smoothed_covariance(int N, const double *P, const double *L, double *smoothed, double *LP)
{
    const long square = (long)N * N;
    double *turned = workspace(5 * square + N);
    if (!turned)
        return;
    double *own = turned + square, *later = own + square, *found = later + square, *both = found + square;
    int *known = (int *)(both + square), count = uncertain(N, P, NULL, known);
    if (count == N) {
        smoothed_and_product(N, P, L, smoothed, LP, turned);
        return;
    }
    pick(count, known, count, known, N, P, own);
    pick(count, known, count, known, N, L, later);
    smoothed_and_product(count, own, later, found, both, turned);
    put(count, known, found, N, smoothed);
    put(count, known, both, N, LP);
}

/* Readings of a frame, Lambda = E M E' + H'H with the first n columns E of the identity: M (n x n), H (m x N) row by
 * row, and R = H' row by row. */
typedef struct {
    int N, n, m;
    const double *M, *H;
    double *R;
} Readings;

/* Products of a curvature L, a covariance P and the smoothed one, S = P - P L P: L P E, L P H', E'S E, E'S H' and H S H',
 * column by column; memory for the last but one turned, and for products of M. */
typedef struct {
    double *LPE, *LPH, *ESE, *ESH, *HSH, *HSE, *MESE, *MESH;
} Products;

static long products_size(int N, int n, int m) { return (long)n * (N + 2L * n + 3L * m) + (long)m * (2L * N + m); }

/* Memory of products and of the readings' transposed rows; returns what lies behind it. */
static double *arranged(Readings *y, Products *p, double *work)
{
    const long N = y->N, n = y->n, m = y->m;
    y->R = work;
    p->LPE = y->R + m * N;
    p->LPH = p->LPE + n * N;
    p->ESE = p->LPH + m * N;
    p->ESH = p->ESE + n * n;
    p->HSH = p->ESH + n * m;
    transposed(y->N, y->m, y->H, y->N, y->R);
    p->HSE = p->HSH + m * m;
    p->MESE = p->HSE + m * n;
    p->MESH = p->MESE + n * n;
    return p->MESH + n * m;
}

/* out (N x m) = X H' */
static void times_rows(const Readings *y, const double *X, double *out)
{
    for (Band b = {0, 0, 0, 0}; b.end < y->m;) {
        b = band_from(b.end, y->m, y->N, y->H);
        product(WHOLE, y->N, b.end - b.start, b.last - b.first, 1.0, X + (long)b.first * y->N, y->N,
                y->R + (long)b.first * y->m + b.start, y->m, 0.0, NULL, out + (long)b.start * y->N, y->N);
    }
}

/* out (m x m) = H X of X' (m x N). */
static void rows_times(const Readings *y, const double *turned, double *out)
{
    for (Band b = {0, 0, 0, 0}; b.end < y->m;) {
        b = band_from(b.end, y->m, y->N, y->H);
        product(WHOLE, b.end - b.start, y->m, b.last - b.first, 1.0, y->R + (long)b.first * y->m + b.start, y->m,
                turned + (long)b.first * y->m, y->m, 0.0, NULL, out + b.start, y->m);
    }
}

/* X (N x columns) += H' Y' / 2 of Y (columns x m). */
static void add_rows(const Readings *y, int columns, const double *Y, double *X)
{
    for (Band b = {0, 0, 0, 0}; b.end < y->m;) {
        b = band_from(b.end, y->m, y->N, y->H);
        product(WHOLE, b.last - b.first, columns, b.end - b.start, 0.5, y->H + (long)b.start * y->N + b.first, y->N,
                Y + (long)b.start * columns, columns, 1.0, X + b.first, X + b.first, y->N);
    }
}

/* The first n rows of X (N x columns) += Y / 2. */
static void add_first(int N, int n, int columns, const double *Y, double *X)
{
    for (int j = 0; j < columns; j++)
        for (int i = 0; i < n; i++)
            X[(long)j * N + i] += 0.5 * Y[(long)j * n + i];
}

/* of (n x columns): the first n rows of X (N x columns). */
static void first_rows(int N, int n, int columns, const double *X, double *of)
{
    for (int j = 0; j < columns; j++)
        memcpy(of + (long)j * n, X + (long)j * N, sizeof *X * n);
}

static void without_identity(int n, double *X)
{
    for (int i = 0; i < n; i++)
        X[(long)i * (n + 1)] -= 1.0;
}

/* L + Lambda - V - V' with V = (L P + Lambda S / 2) Lambda, from V - Lambda / 2; products are overwritten. */
static void before_readings(const Readings *y, const Products *p, const double *L, double *before)
{
    const int N = y->N, n = y->n, m = y->m;
    product(WHOLE, n, n, n, 1.0, y->M, n, p->ESE, n, 0.0, NULL, p->MESE, n);
    transposed(n, m, p->ESH, n, p->HSE);
    product(WHOLE, n, m, n, 1.0, y->M, n, p->HSE, m, 0.0, NULL, p->MESH, n);
    without_identity(n, p->MESE);
    without_identity(m, p->HSH);
    add_first(N, n, n, p->MESE, p->LPE);
    add_first(N, n, m, p->MESH, p->LPH);
    add_rows(y, n, p->ESH, p->LPE);
    add_rows(y, m, p->HSH, p->LPH);
    product(WHOLE, N, n, n, -1.0, p->LPE, N, y->M, n, 0.5, L, before, N);
    for (long i = (long)n * N; i < (long)N * N; i++)
        before[i] = 0.5 * L[i];
    for (Band b = {0, 0, 0, 0}; b.end < m;) {
        b = band_from(b.end, m, N, y->H);
        double *own = before + (long)b.first * N;
        product(WHOLE, N, b.last - b.first, b.end - b.start, -1.0, p->LPH + (long)b.start * N, N,
                y->H + (long)b.start * N + b.first, N, 1.0, own, own, N);
    }
    symmetrise(N, before);
}

static long readings_work(int N, int n, int m) { return products_size(N, n, m) + (long)N * (n + 3L * m); }

/* From the smoothed covariance S and L P. */
static void before_smoothed(int N, int n, int m, const double *L, const double *S, const double *LP, const double *M,
                            const double *H, double *before, double *work)
{
    Readings y = {N, n, m, M, H, NULL};
    Products p;
    double *SH = arranged(&y, &p, work), *HS = SH + (long)m * N;
    memcpy(p.LPE, LP, sizeof *LP * n * N);
    times_rows(&y, LP, p.LPH);
    times_rows(&y, S, SH);
    transposed(N, m, SH, N, HS);
    rows_times(&y, HS, p.HSH);
    first_rows(N, n, n, S, p.ESE);
    first_rows(N, n, m, SH, p.ESH);
    before_readings(&y, &p, L, before);
}

/* From P alone, by products of L and P with the readings' n + m columns. */
static void before_alone(int N, int n, int m, const double *L, const double *P, const double *M, const double *H,
                         double *before, double *work)
{
    Readings y = {N, n, m, M, H, NULL};
    Products p;
    double *PH = arranged(&y, &p, work), *HP = PH + (long)m * N, *EPL = HP + (long)m * N, *HPL = EPL + (long)n * N;
    times_rows(&y, P, PH);
    transposed(N, m, PH, N, HP);
    product(WHOLE, N, n, N, 1.0, L, N, P, N, 0.0, NULL, p.LPE, N);
    product(WHOLE, N, m, N, 1.0, L, N, HP, m, 0.0, NULL, p.LPH, N);
    transposed(N, n, p.LPE, N, EPL);
    transposed(N, m, p.LPH, N, HPL);
    first_rows(N, n, n, P, p.ESE);
    first_rows(N, n, m, PH, p.ESH);
    rows_times(&y, HP, p.HSH);
    product(WHOLE, n, n, N, -1.0, P, N, EPL, n, 1.0, p.ESE, p.ESE, n);
    product(WHOLE, n, m, N, -1.0, P, N, HPL, m, 1.0, p.ESH, p.ESH, n);
    product(WHOLE, m, m, N, -1.0, HP, m, HPL, m, 1.0, p.HSH, p.HSH, m);
    before_readings(&y, &p, L, before);
}

static void before_either(int N, int n, int m, const double *L, const double *X, const double *LP, const double *M,
                          const double *H, double *before, double *work)
{
    if (LP)
        before_smoothed(N, n, m, L, X, LP, M, H, before, work);
    else
        before_alone(N, n, m, L, X, M, H, before, work);
}

/* X: the smoothed covariance, or P where LP is NULL. Curvature in components that are certain counts nowhere, and is
 * left out. */
static void without_certain(int N, int n, int m, const double *L, const double *X, const double *LP,
                            const double *information, const double *rows, double *before)
{
    const long square = (long)N * N;
    double *own = workspace(4 * square + (long)m * N + (long)n * n + N + readings_work(N, n, m));
    if (!own)
        return;
    double *later = own + square, *both = later + square, *found = both + square, *first = found + square;
    double *others = first + (long)n * n, *work = others + (long)m * N;
    int *known = (int *)work, count = uncertain(N, X, LP, known), ahead = 0;
    work += N;
    while (ahead < count && known[ahead] < n)
        ahead++;
    if (count == N || !ahead) {
        before_either(N, n, m, L, X, LP, information, rows, before, work);
        return;
    }
    pick(count, known, count, known, N, L, later);
    pick(count, known, count, known, N, X, own);
    if (LP)
        pick(count, known, count, known, N, LP, both);
    pick(ahead, known, ahead, known, n, information, first);
    pick(m, NULL, count, known, N, rows, others);
    before_either(count, ahead, m, later, own, LP ? both : NULL, first, others, found, work);
    put(count, known, found, N, before);
}

void mbkf_curvature_before_readings(int N, int n, int m, const double *L, const double *smoothed, const double *LP,
                                    const double *information, const double *rows, double *before)
{
    without_certain(N, n, m, L, smoothed, LP, information, rows, before);
}

void mbkf_curvature_before_readings_alone(int N, int n, int m, const double *L, const double *P,
                                          const double *information, const double *rows, double *before)
{
    without_certain(N, n, m, L, P, NULL, information, rows, before);
}
