/* Arrays that a call from Python brings, as memory that is checked. */
#ifndef MBKF_ARRAYS_H
#define MBKF_ARRAYS_H

#define PY_SSIZE_T_CLEAN
#ifndef Py_LIMITED_API
#define Py_LIMITED_API 0x030B0000 /* one build for every Python from 3.11 on */
#endif
#include <Python.h>

/* Arrays of a call, released together. */
enum { MOST_ARRAYS = 16 };
typedef struct {
    Py_buffer views[MOST_ARRAYS];
    int held;
} Arrays;

static inline void release(Arrays *arrays)
{
    while (arrays->held)
        PyBuffer_Release(&arrays->views[--arrays->held]);
}

/* Memory of an array in one piece, of numbers of some bytes, as many as said or more; NULL with an error set. */
static inline void *array(Arrays *arrays, PyObject *object, int flags, Py_ssize_t bytes, Py_ssize_t count)
{
    Py_buffer *view = &arrays->views[arrays->held];
    if (PyObject_GetBuffer(object, view, flags | PyBUF_ND) < 0)
        return NULL;
    arrays->held++;
    if (view->itemsize != bytes || view->len < count * bytes) {
        PyErr_SetString(PyExc_ValueError, "an array of another type or size is needed");
        return NULL;
    }
    return view->buf;
}

static inline double *numbers(Arrays *arrays, PyObject *object, Py_ssize_t count)
{
    return array(arrays, object, PyBUF_C_CONTIGUOUS, sizeof(double), count);
}

/* Of a symmetric matrix, whose order does not matter. */
static inline double *symmetric(Arrays *arrays, PyObject *object, Py_ssize_t size)
{
    return array(arrays, object, PyBUF_ANY_CONTIGUOUS, sizeof(double), size * size);
}

static inline double *filled(Arrays *arrays, PyObject *object, Py_ssize_t count)
{
    return array(arrays, object, PyBUF_ANY_CONTIGUOUS | PyBUF_WRITABLE, sizeof(double), count);
}

/* Rows or first dimension of the array taken last. */
static inline int length(const Arrays *arrays)
{
    const Py_buffer *view = &arrays->views[arrays->held - 1];
    return view->ndim ? (int)view->shape[0] : 1;
}

static inline int expects(Py_ssize_t given, Py_ssize_t wanted)
{
    if (given == wanted)
        return 1;
    PyErr_SetString(PyExc_TypeError, "another number of arguments is needed");
    return 0;
}

#endif
