/* Python's side of spread.c and joint_rates.c; part of module.c, whose arrays and workspace it takes. */
#ifndef MBKF_SPREAD_BINDINGS_H
#define MBKF_SPREAD_BINDINGS_H

#include "joint_rates.h"
#include "spread.h"

static double *columns(Arrays *arrays, PyObject *object, Py_ssize_t count)
{
    return array(arrays, object, PyBUF_F_CONTIGUOUS, sizeof(double), count);
}

static int *integers(Arrays *arrays, PyObject *object, Py_ssize_t count)
{
    return array(arrays, object, PyBUF_C_CONTIGUOUS, sizeof(int), count);
}

/* Columns of the array taken last. */
static int breadth(const Arrays *arrays)
{
    const Py_buffer *view = &arrays->views[arrays->held - 1];
    return view->ndim > 1 ? (int)view->shape[1] : 1;
}

static int within(int count, const int *indices, int most)
{
    for (int k = 0; k < count; k++)
        if (indices[k] < 0 || indices[k] > most)
            return 0;
    return 1;
}

/* All that is read off the errors, one below the other: their diagonal, T's, U's, and the blocks. */
static int read_off(const Errors *e, int m, int n, const double *T, int k, int l, const double *U, int n_first,
                    const int *first, double *found)
{
    const long roots = (long)e->nv * e->nv, diagonal = root_work(e->nv);
    const long of_T = error_work(m, n, e->nv), of_U = error_work(k, l, e->nv);
    long most = diagonal > of_T ? diagonal : of_T;
    most = most > of_U ? most : of_U;
    double *root = workspace(roots + most);
    if (!root)
        return -1;
    int failed;
    Py_BEGIN_ALLOW_THREADS
    failed = error_diagonal(e, root, found, root + roots);
    if (!failed) {
        error_of(e, root, m, n, T, found + e->N, root + roots);
        error_of(e, root, k, l, U, found + e->N + m, root + roots);
        error_blocks(e, root, n_first, first, found + e->N + m + k);
    }
    Py_END_ALLOW_THREADS
    return failed;
}

/* errors(P, information, seen, size, constants, rows, T, U, first, found) -> 0, or which factorisation failed */
static PyObject *py_errors(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    Errors e = {0};
    (void)self;
    if (!expects(given, 10))
        return NULL;
    e.P = symmetric(&held, args[0], 0);
    e.N = e.P ? length(&held) : 0;
    e.information = e.P ? symmetric(&held, args[1], 0) : NULL;
    e.nv = e.information ? length(&held) : 0;
    e.seen = e.information ? integers(&held, args[2], 0) : NULL;
    e.n_seen = e.seen ? length(&held) : 0;
    e.size = e.seen ? numbers(&held, args[3], e.N) : NULL;
    const double *constants = e.size ? numbers(&held, args[4], 2) : NULL;
    e.rows = constants ? numbers(&held, args[5], 0) : NULL;
    e.n_rows = e.rows ? length(&held) : 0;
    const double *T = e.rows ? columns(&held, args[6], 0) : NULL;
    const int m = T ? length(&held) : 0, n = T ? breadth(&held) : 0;
    const double *U = T ? columns(&held, args[7], 0) : NULL;
    const int k = U ? length(&held) : 0, l = U ? breadth(&held) : 0;
    const int *first = U ? integers(&held, args[8], 0) : NULL;
    const int n_first = first ? length(&held) : 0;
    double *found = first ? filled(&held, args[9], (Py_ssize_t)e.N + m + k + 9 * n_first) : NULL;
    if (found) {
        const Py_ssize_t of_rows = held.views[5].len / (Py_ssize_t)sizeof(double);
        if (3 * e.nv > e.N || n > e.N || l > e.N || n < e.nv || l < e.nv || of_rows != (Py_ssize_t)e.n_rows * e.N ||
            !within(e.n_seen, e.seen, e.nv - 1) || !within(n_first, first, e.nv - 3) || e.n_seen > e.nv)
            PyErr_SetString(PyExc_ValueError, "the arrays' sizes do not fit");
        else {
            e.skin = constants[0];
            e.rate = constants[1];
            const int failed = read_off(&e, m, n, T, k, l, U, n_first, first, found);
            done = failed < 0 ? NULL : PyLong_FromLong(failed);
        }
    }
    release(&held);
    return done;
}

/* joint_variances(q, places, signs, root, axes, covariance, variance) */
static PyObject *py_joint_variances(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    JointReading r = {0};
    (void)self;
    if (!expects(given, 7))
        return NULL;
    const double *q = numbers(&held, args[0], 0);
    const int nq = q ? length(&held) : 0;
    r.places = q ? integers(&held, args[1], 0) : NULL;
    r.count = r.places ? length(&held) : 0;
    r.signs = r.places ? numbers(&held, args[2], 4 * (Py_ssize_t)r.count) : NULL;
    r.root = r.signs ? (int)PyLong_AsLong(args[3]) : 0;
    r.axes = r.signs && !PyErr_Occurred() ? numbers(&held, args[4], 9) : NULL;
    const double *covariance = r.axes ? numbers(&held, args[5], 0) : NULL;
    const int sets = covariance ? length(&held) : 0;
    double *variance = covariance ? filled(&held, args[6], 3 * (Py_ssize_t)sets * (r.count + 1)) : NULL;
    if (variance) {
        int fits = held.views[1].len == (Py_ssize_t)sizeof(int) * 4 * r.count && r.root >= 0 && r.root <= nq - 4;
        for (int b = 0; fits && b < r.count; b++)
            fits = within(1, r.places + 4 * b, nq - 4) && within(3, r.places + 4 * b + 1, 2);
        if (!fits || held.views[4].len != (Py_ssize_t)sizeof(double) * 9 * sets * (r.count + 1))
            PyErr_SetString(PyExc_ValueError, "the arrays' sizes do not fit");
        else {
            joint_variances(&r, q, sets, covariance, variance);
            done = Py_NewRef(Py_None);
        }
    }
    release(&held);
    return done;
}

#define SPREAD_METHODS                                                                                             \
    {"errors", (PyCFunction)(void (*)(void))py_errors, METH_FASTCALL, "Variances that a state's errors give."},     \
        {"joint_variances", (PyCFunction)(void (*)(void))py_joint_variances, METH_FASTCALL,                         \
         "Variances of joints' angles."}

#endif
