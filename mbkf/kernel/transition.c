/* Products with a transition Phi and its inverse, which leave out its zeros: it couples a joint's dofs alone. */
#include "transition.h"

#include <math.h>
#include <string.h>

#include "lanes.h"
#include "vectorised.h"

enum { TERMS = 24 }; /* rows that are added at once */

/* A row `out` (N) as a sum of multiples of others, which are added many at once: rows come from the slower caches. */
typedef struct {
    int N, count, begun;
    double *out;
    double factor[TERMS];
    const double *row[TERMS];
} Sum;

VECTORISED static void write_terms(Sum *sum)
{
    double *out = sum->out;
    int j = 0;
    for (; j + LANES <= sum->N; j += LANES) {
        Lanes total;
        memset(&total, 0, sizeof total);
        if (sum->begun)
            memcpy(&total, out + j, sizeof total);
        for (int k = 0; k < sum->count; k++)
            add_multiple(&total, sum->factor[k], (const Lanes *)(sum->row[k] + j));
        memcpy(out + j, &total, sizeof total);
    }
    for (; j < sum->N; j++) {
        double total = sum->begun ? out[j] : 0.0;
        for (int k = 0; k < sum->count; k++)
            total += sum->factor[k] * sum->row[k][j];
        out[j] = total;
    }
    sum->begun = 1;
    sum->count = 0;
}

static void add_term(Sum *sum, double factor, const double *row)
{
    if (factor == 0.0)
        return;
    if (sum->count == TERMS)
        write_terms(sum);
    sum->factor[sum->count] = factor;
    sum->row[sum->count++] = row;
}

static void joint_rows_before(int first, int end, int N, const Transition *phi, const double *L, double *out)
{
    const int nv = phi->nv, orders = phi->orders;
    for (int i = first; i < end; i++) {
        Sum sum = {.N = N, .out = out + (long)i * N};
        for (int k = first; k < end; k++)
            add_term(&sum, phi->A[k * nv + i], L + (long)k * N);
        write_terms(&sum);
        for (int order = 0; order < orders; order++) {
            sum = (Sum){.N = N, .out = out + (long)((1 + order) * nv + i) * N};
            for (int k = first; k < end; k++)
                add_term(&sum, phi->push[order] * phi->B[k * nv + i], L + (long)k * N);
            for (int of = 0; of < orders; of++)
                add_term(&sum, phi->rates[of * orders + order], L + (long)((1 + of) * nv + i) * N);
            write_terms(&sum);
        }
    }
}

void rows_before(int N, const double *L, const Transition *phi, double *out)
{
    const long rest = (long)(1 + phi->orders) * phi->nv * N;
    for (int k = 0; k < phi->J; k++)
        joint_rows_before(phi->joints[2 * k], phi->joints[2 * k + 1], N, phi, L, out);
    memcpy(out + rest, L + rest, sizeof(double) * ((long)N * N - rest));
}

static void joint_rows_after(int first, int end, int N, const Transition *phi, const double *X, double *out)
{
    const int nv = phi->nv, orders = phi->orders;
    for (int i = first; i < end; i++) {
        Sum sum = {.N = N, .out = out + (long)i * N};
        for (int k = first; k < end; k++) {
            add_term(&sum, phi->A[i * nv + k], X + (long)k * N);
            for (int order = 0; order < orders; order++)
                add_term(&sum, phi->push[order] * phi->B[i * nv + k], X + (long)((1 + order) * nv + k) * N);
        }
        write_terms(&sum);
        for (int order = 0; order < orders; order++) {
            sum = (Sum){.N = N, .out = out + (long)((1 + order) * nv + i) * N};
            for (int of = 0; of < orders; of++)
                add_term(&sum, phi->rates[order * orders + of], X + (long)((1 + of) * nv + i) * N);
            write_terms(&sum);
        }
    }
}

void rows_after(int N, const double *X, const Transition *phi, double *out)
{
    const long rest = (long)(1 + phi->orders) * phi->nv * N;
    for (int k = 0; k < phi->J; k++)
        joint_rows_after(phi->joints[2 * k], phi->joints[2 * k + 1], N, phi, X, out);
    memcpy(out + rest, X + rest, sizeof(double) * ((long)N * N - rest));
}

void vector_before(int N, const Transition *phi, const double *gradient, double *before)
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

void add_moved(int N, const Transition *phi, const double *x, double *y)
{
    const int nv = phi->nv, orders = phi->orders, rest = (1 + orders) * nv;
    const double *rates = x + nv;
    for (int one = 0; one < phi->J; one++)
        for (int k = phi->joints[2 * one]; k < phi->joints[2 * one + 1]; k++) {
            double pushed = 0.0;
            for (int order = 0; order < orders; order++)
                pushed += phi->push[order] * rates[order * nv + k];
            for (int i = phi->joints[2 * one]; i < phi->joints[2 * one + 1]; i++)
                y[i] += phi->A[i * nv + k] * x[k] + phi->B[i * nv + k] * pushed;
        }
    for (int order = 0; order < orders; order++)
        for (int of = 0; of < orders; of++)
            for (int i = 0; i < nv; i++)
                y[(1 + order) * nv + i] += phi->rates[order * orders + of] * rates[of * nv + i];
    for (int i = rest; i < N; i++)
        y[i] += x[i];
}

/* X (n x n) = A^-1 by Gauss and Jordan; both have rows of the given length, and A is overwritten. Returns 1 if A has
 * no inverse. */
static int inverted(int n, int length, double *A, double *X)
{
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            X[i * length + j] = i == j;
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(A[i * length + k]) > fabs(A[pivot * length + k]))
                pivot = i;
        const double by = A[pivot * length + k];
        if (!(fabs(by) > 0.0))
            return 1;
        for (int j = 0; j < n; j++) {
            const double a = A[pivot * length + j] / by, x = X[pivot * length + j] / by;
            A[pivot * length + j] = A[k * length + j];
            X[pivot * length + j] = X[k * length + j];
            A[k * length + j] = a;
            X[k * length + j] = x;
        }
        for (int i = 0; i < n; i++) {
            const double factor = A[i * length + k];
            for (int j = 0; j < n && i != k; j++) {
                A[i * length + j] -= factor * A[k * length + j];
                X[i * length + j] -= factor * X[k * length + j];
            }
        }
    }
    return 0;
}

long inverse_size(int nv, int orders) { return 3L * nv * nv + 3L * orders * orders + orders; }

int inverse(const Transition *phi, Transition *back, double *work)
{
    const int nv = phi->nv, orders = phi->orders;
    const long square = (long)nv * nv;
    double *A = work, *B = A + square, *own = B + square, *rates = own + square;
    double *push = rates + orders * orders, *R = push + orders;
    memcpy(own, phi->A, sizeof *own * square);
    memcpy(R, phi->rates, sizeof *R * orders * orders);
    memset(push, 0, sizeof *push * orders);
    memset(A, 0, sizeof *A * 2 * square);
    if (inverted(orders, orders, R, rates))
        return 1;
    for (int of = 0; of < orders; of++)
        for (int order = 0; order < orders; order++)
            push[order] += phi->push[of] * rates[of * orders + order];
    for (int one = 0; one < phi->J; one++) {
        const int first = phi->joints[2 * one], end = phi->joints[2 * one + 1];
        if (inverted(end - first, nv, own + (long)first * (nv + 1), A + (long)first * (nv + 1)))
            return 1;
        for (int i = first; i < end; i++)
            for (int k = first; k < end; k++)
                for (int j = first; j < end; j++)
                    B[i * nv + j] -= A[i * nv + k] * phi->B[k * nv + j];
    }
    *back = (Transition){nv, orders, phi->J, A, B, push, rates, phi->joints};
    return 0;
}
