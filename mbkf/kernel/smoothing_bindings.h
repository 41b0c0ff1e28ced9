/* Python's side of smoothing.c; part of module.c, whose arrays and workspace it takes. */
#ifndef MBKF_SMOOTHING_BINDINGS_H
#define MBKF_SMOOTHING_BINDINGS_H

#include "smoothing.h"

/* before_motion(L, A, B, joints, push, rates, before) */
static PyObject *py_before_motion(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    Rates phi = {0};
    (void)self;
    if (!expects(given, 7))
        return NULL;
    const double *L = symmetric(&held, args[0], 0);
    const int N = L ? length(&held) : 0;
    phi.A = L ? numbers(&held, args[1], 0) : NULL;
    phi.nv = phi.A ? length(&held) : 0;
    phi.B = phi.A ? numbers(&held, args[2], (Py_ssize_t)phi.nv * phi.nv) : NULL;
    phi.joints = phi.B ? array(&held, args[3], PyBUF_C_CONTIGUOUS, sizeof(int), 0) : NULL;
    phi.n_joints = phi.joints ? length(&held) : 0;
    if (phi.joints && !are_joints(&held, phi.joints, phi.n_joints, phi.nv))
        phi.joints = NULL;
    phi.push = phi.joints ? numbers(&held, args[4], 0) : NULL;
    phi.orders = phi.push ? length(&held) : 0;
    phi.rates = phi.push ? numbers(&held, args[5], (Py_ssize_t)phi.orders * phi.orders) : NULL;
    double *before = phi.rates ? filled(&held, args[6], (Py_ssize_t)N * N) : NULL;
    double *work = before ? workspace(motion_work(N, phi.nv)) : NULL;
    if (work) {
        if (N < (1 + phi.orders) * phi.nv)
            PyErr_SetString(PyExc_ValueError, "the curvature is smaller than the state");
        else if (is_square(&held.views[0], N) && is_square(&held.views[1], phi.nv)) {
            curvature_before_motion(N, L, &phi, before, work);
            done = Py_NewRef(Py_None);
        }
    }
    release(&held);
    return done;
}

/* smoothed(P, L, smoothed, LP) */
static PyObject *py_smoothed(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    if (!expects(given, 4))
        return NULL;
    const double *P = symmetric(&held, args[0], 0);
    const int N = P ? length(&held) : 0;
    const double *L = P ? symmetric(&held, args[1], N) : NULL;
    double *smoothed = L ? filled(&held, args[2], (Py_ssize_t)N * N) : NULL;
    double *LP = smoothed ? filled(&held, args[3], (Py_ssize_t)N * N) : NULL;
    double *work = LP ? workspace((long)N * N) : NULL;
    if (work && is_square(&held.views[0], N)) {
        smoothed_covariance(N, P, L, smoothed, LP, work);
        done = Py_NewRef(Py_None);
    }
    release(&held);
    return done;
}

/* before_readings(L, smoothed, LP, information, rows, before) */
static PyObject *py_before_readings(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    if (!expects(given, 6))
        return NULL;
    const double *L = symmetric(&held, args[0], 0);
    const int N = L ? length(&held) : 0;
    const double *smoothed = L ? symmetric(&held, args[1], N) : NULL;
    const double *LP = smoothed ? numbers(&held, args[2], (Py_ssize_t)N * N) : NULL;
    const double *information = LP ? symmetric(&held, args[3], 0) : NULL;
    const int n = information ? length(&held) : 0;
    const double *rows = information ? numbers(&held, args[4], 0) : NULL;
    const int m = rows ? length(&held) : 0;
    double *before = rows ? filled(&held, args[5], (Py_ssize_t)N * N) : NULL;
    double *work = before ? workspace(readings_work(N, m)) : NULL;
    if (work) {
        if (n > N || (m && held.views[4].len != (Py_ssize_t)sizeof(double) * m * N))
            PyErr_SetString(PyExc_ValueError, "the arrays' sizes do not fit");
        else if (is_square(&held.views[0], N) && is_square(&held.views[3], n)) {
            curvature_before_readings(N, L, smoothed, LP, n, information, m, rows, before, work);
            done = Py_NewRef(Py_None);
        }
    }
    release(&held);
    return done;
}

#define SMOOTHING_METHODS                                                                                          \
    {"before_motion", (PyCFunction)(void (*)(void))py_before_motion, METH_FASTCALL,                                 \
     "A curvature before a step of the motion."},                                                                  \
        {"smoothed", (PyCFunction)(void (*)(void))py_smoothed, METH_FASTCALL, "A smoothed covariance."},            \
        {"before_readings", (PyCFunction)(void (*)(void))py_before_readings, METH_FASTCALL,                         \
         "A curvature before a frame's readings."}

#endif
