/* Orientations over a recording, for Python. The caller is mbkf/imu/orientation_course.py only, which says what the
 * arguments mean; what is checked here is that no memory is read that is not theirs. */
#include "orientation_binding.h"

#include <stdlib.h>

#include "orientation.h"

/* orientation_course(noise, start, gyro, force, field or None, course, smooth) */
static PyObject *py_orientation_course(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    if (!expects(given, 7))
        return NULL;
    const OrientationNoise *noise = (void *)numbers(&held, args[0], NOISE_NUMBERS);
    const double *start = noise ? numbers(&held, args[1], 0) : NULL;
    const int N = start ? length(&held) : 0;
    const int fits = start && held.views[1].len == (Py_ssize_t)sizeof(OrientationState) * N;
    const double *gyro = start ? numbers(&held, args[2], 0) : NULL;
    const int T = gyro ? length(&held) : 0;
    const Py_ssize_t count = 3 * (Py_ssize_t)T * N;
    const int shaped = gyro && held.views[2].len == (Py_ssize_t)sizeof(double) * count;
    const double *force = gyro ? numbers(&held, args[3], count) : NULL;
    const double *field = force && args[4] != Py_None ? numbers(&held, args[4], count) : NULL;
    double *course = force && (field || args[4] == Py_None)
                         ? array(&held, args[5], PyBUF_C_CONTIGUOUS | PyBUF_WRITABLE, sizeof(double),
                                 COURSE_NUMBERS * (Py_ssize_t)T * N)
                         : NULL;
    const int smooth = course ? PyObject_IsTrue(args[6]) : 0;
    if (course && (!fits || !shaped || T < 1))
        PyErr_SetString(PyExc_ValueError, "the arrays' sizes do not fit");
    else if (course && smooth >= 0) {
        OrientationState *states = smooth ? malloc(sizeof *states * T) : NULL;
        OrientationStep *steps = smooth ? malloc(sizeof *steps * T) : NULL;
        int sound = 1;
        if (smooth && (!states || !steps))
            PyErr_NoMemory();
        else {
            Py_BEGIN_ALLOW_THREADS
            for (int n = 0; n < N && sound; n++)
                sound = orientation_course(noise, (const OrientationState *)start + n, T, 3L * N, gyro + 3 * n,
                                           force + 3 * n, field ? field + 3 * n : NULL,
                                           course + (long)n * T * COURSE_NUMBERS, states, steps);
            Py_END_ALLOW_THREADS
            done = PyBool_FromLong(sound);
        }
        free(states);
        free(steps);
    }
    release(&held);
    return done;
}

PyMethodDef orientation_functions[] = {
    {"orientation_course", (PyCFunction)(void (*)(void))py_orientation_course, METH_FASTCALL,
     "Orientations of sensors over a recording, filtered or smoothed."},
    {NULL, NULL, 0, NULL},
};
