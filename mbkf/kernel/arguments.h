/* Checks of a call's arguments, and results as new arrays; used by the binding, which .ci/kernel_binding.py makes. */
#ifndef MBKF_ARGUMENTS_H
#define MBKF_ARGUMENTS_H

#define PY_SSIZE_T_CLEAN
#ifndef Py_LIMITED_API
#define Py_LIMITED_API 0x030B0000 /* one build for every Python from 3.11 on */
#endif
#define NPY_NO_DEPRECATED_API NPY_2_0_API_VERSION
#include <Python.h>
#include <numpy/arrayobject.h>
#undef I /* of complex.h, which NumPy includes */

#include <limits.h>

#include "call.h"

enum { FLOAT64 = NPY_DOUBLE, INT32 = NPY_INT, BOOL = NPY_BOOL };
enum { C_ORDER = 1, FORTRAN_ORDER = 2, ANY_ORDER = 3, WRITABLE = 4, ANY_DIMENSIONS = 8 };

/* Names for messages. */
typedef struct {
    const char *function, *argument;
} Place;

static inline PyArrayObject *array(PyObject *object) { return (PyArrayObject *)object; }
static inline void *memory(PyObject *object) { return PyArray_DATA(array(object)); }
static inline npy_intp extent(PyObject *object, int axis) { return PyArray_DIM(array(object), axis); }

static inline npy_intp extent_from_end(PyObject *object, int axis)
{
    return extent(object, PyArray_NDIM(array(object)) - axis);
}

/* Product of all extents but the last so many. */
static inline npy_intp leading_extent(PyObject *object, int last)
{
    npy_intp product = 1;
    for (int axis = 0; axis < PyArray_NDIM(array(object)) - last; axis++)
        product *= extent(object, axis);
    return product;
}

static int has_arguments(const char *function, Py_ssize_t count, int expected)
{
    if (count != expected)
        PyErr_Format(PyExc_TypeError, "%s takes %d arguments, got %zd", function, expected, count);
    return count == expected;
}

/* Raises ShapeError of mbkf.errors; returns NULL. */
static PyObject *shape_error(Place place, PyObject *object, PyObject *expected)
{
    PyObject *errors = PyImport_ImportModule("mbkf.errors"), *name = NULL, *shape = NULL, *error = NULL;
    PyObject *type = errors ? PyObject_GetAttrString(errors, "ShapeError") : NULL;
    if (type && expected) {
        name = PyUnicode_FromFormat("%s: %s", place.function, place.argument);
        shape = PyObject_GetAttrString(object, "shape");
        error = name && shape ? PyObject_CallFunctionObjArgs(type, name, expected, shape, NULL) : NULL;
    }
    if (error)
        PyErr_SetObject(type, error);
    Py_XDECREF(errors), Py_XDECREF(type), Py_XDECREF(name), Py_XDECREF(shape), Py_XDECREF(error);
    Py_XDECREF(expected);
    return NULL;
}

/* The same, with the sizes that the names in the text stand for. */
static PyObject *wrong_shape(Place place, PyObject *object, const char *text, int count, const npy_intp *sizes)
{
    PyObject *numbers = PyTuple_New(count), *expected = NULL;
    for (int i = 0; numbers && i < count; i++)
        PyTuple_SetItem(numbers, i, PyLong_FromSsize_t(sizes[i]));
    if (numbers)
        expected = PyUnicode_FromFormat("%s = %S", text, numbers);
    Py_XDECREF(numbers);
    return shape_error(place, object, expected);
}

static int is_kind(PyArrayObject *one, int kind)
{
    const int type = PyArray_TYPE(one);
    return kind == INT32 ? PyTypeNum_ISSIGNED(type) && PyArray_ITEMSIZE(one) == sizeof(int) : type == kind;
}

/* True for an array of this kind, order and number of dimensions; an error is set for others. */
static int is_array(Place place, PyObject *object, int kind, int flags, int dimensions, const char *text)
{
    if (!PyArray_Check(object)) {
        PyObject *type = PyObject_GetAttrString((PyObject *)Py_TYPE(object), "__name__");
        PyErr_Format(PyExc_TypeError, "%s: %s must be an array, got %V", place.function, place.argument, type, "?");
        Py_XDECREF(type);
        return 0;
    }
    PyArrayObject *one = array(object);
    const char *wrong = NULL;
    if (!is_kind(one, kind) || !PyArray_ISBEHAVED_RO(one)) {
        PyErr_Format(PyExc_TypeError, "%s: %s must hold %s, aligned and in the machine's byte order, got %S",
                     place.function, place.argument, kind == FLOAT64 ? "float64" : kind == INT32 ? "int32" : "bool",
                     (PyObject *)PyArray_DESCR(one));
        return 0;
    }
    if (PyArray_NDIM(one) != dimensions && !(flags & ANY_DIMENSIONS && PyArray_NDIM(one) > dimensions)) {
        shape_error(place, object, PyUnicode_FromString(text));
        return 0;
    }
    if (!(flags & C_ORDER && PyArray_IS_C_CONTIGUOUS(one)) && !(flags & FORTRAN_ORDER && PyArray_IS_F_CONTIGUOUS(one)))
        wrong = (flags & ANY_ORDER) == ANY_ORDER ? "be contiguous" : flags & C_ORDER ? "be in C order" : "be in Fortran order";
    else if (flags & WRITABLE && !PyArray_ISWRITEABLE(one))
        wrong = "be writable, and is read-only";
    for (int axis = 0; axis < PyArray_NDIM(one); axis++)
        if (PyArray_DIM(one, axis) > INT_MAX)
            wrong = "have fewer elements along each axis";
    if (wrong)
        PyErr_Format(PyExc_TypeError, "%s: %s must %s", place.function, place.argument, wrong);
    return !wrong;
}

/* True if all indices (int32) are at least low and below end; an error is set if not. */
static int are_within(Place place, PyObject *object, npy_intp low, npy_intp end)
{
    const int *index = memory(object);
    const npy_intp count = PyArray_SIZE(array(object));
    for (npy_intp i = 0; i < count; i++)
        if (index[i] < low || index[i] >= end) {
            PyErr_Format(PyExc_ValueError, "%s: %s must lie from %zd to %zd, got %d", place.function, place.argument,
                         (Py_ssize_t)low, (Py_ssize_t)end - 1, index[i]);
            return 0;
        }
    return 1;
}

/* Replaces the error that a conversion has set by one that names the argument. */
static int is_converted(Place place, const char *needed)
{
    if (!PyErr_Occurred())
        return 1;
    PyErr_Clear();
    PyErr_Format(PyExc_TypeError, "%s: %s must be %s", place.function, place.argument, needed);
    return 0;
}

static int float_argument(Place place, PyObject *object, double *value)
{
    *value = PyFloat_AsDouble(object);
    return is_converted(place, "a number");
}

static int int_argument(Place place, PyObject *object, int *value)
{
    const long number = PyLong_AsLong(object);
    if (number > INT_MAX || number < INT_MIN)
        PyErr_SetNone(PyExc_OverflowError);
    *value = (int)number;
    return is_converted(place, "an integer of 32 bits");
}

static int bool_argument(Place place, PyObject *object, int *value)
{
    *value = 0;
    if (PyBool_Check(object) || PyArray_IsScalar(object, Bool))
        *value = PyObject_IsTrue(object);
    else
        PyErr_SetNone(PyExc_TypeError);
    return is_converted(place, "True or False");
}

static void *handle_argument(Place place, PyObject *object, const char *kind)
{
    if (PyCapsule_IsValid(object, kind))
        return PyCapsule_GetPointer(object, kind);
    PyErr_Format(PyExc_TypeError, "%s: %s must be a handle of a %s", place.function, place.argument, kind);
    return NULL;
}

/* A record's field, by name. */
static int field_read(Place place, PyObject *record, const char *name, int (*read)(Place, PyObject *, void *), void *value)
{
    PyObject *found = PyObject_GetAttrString(record, name);
    if (!found) {
        PyErr_Clear();
        PyErr_Format(PyExc_TypeError, "%s: %s has no '%s'", place.function, place.argument, name);
        return 0;
    }
    const int sound = read((Place){place.function, name}, found, value);
    Py_DECREF(found);
    return sound;
}

static inline int float_read(Place place, PyObject *object, void *value) { return float_argument(place, object, value); }
static inline int int_read(Place place, PyObject *object, void *value) { return int_argument(place, object, value); }
static inline int bool_read(Place place, PyObject *object, void *value) { return bool_argument(place, object, value); }

enum { MOST_DIMENSIONS = 4 };
typedef struct {
    int kind, fortran, dimensions;
    npy_intp extents[MOST_DIMENSIONS];
} Shape;

/* New arrays, not filled; 0 with an error set where there is no memory. */
static int made_arrays(int count, Shape *shapes, PyObject **arrays)
{
    for (int i = 0; i < count; i++) {
        arrays[i] = PyArray_EMPTY(shapes[i].dimensions, shapes[i].extents, shapes[i].kind, shapes[i].fortran);
        if (!arrays[i]) {
            while (i--)
                Py_DECREF(arrays[i]);
            return 0;
        }
    }
    return 1;
}

/* True if the function has refused the call; its results are given up then. */
static int is_refused(const char *function, int count, PyObject **arrays)
{
    const char *reason = taken_refusal();
    if (!reason)
        return 0;
    if (reason == out_of_memory)
        PyErr_NoMemory();
    else
        PyErr_Format(PyExc_ValueError, "%s: %s", function, reason);
    while (count--)
        Py_DECREF(arrays[count]);
    return 1;
}

/* A tuple of objects that it takes over; NULL where one of them is. */
static PyObject *packed(int count, PyObject **objects)
{
    PyObject *tuple = PyTuple_New(count);
    int sound = tuple != NULL;
    for (int i = 0; i < count; i++) {
        sound = sound && objects[i];
        if (tuple)
            PyTuple_SetItem(tuple, i, objects[i]);
        else
            Py_XDECREF(objects[i]);
    }
    if (!sound)
        Py_CLEAR(tuple);
    return tuple;
}

/* A capsule of what a function has made, which keeps its owner alive. */
static PyObject *new_handle(void *made, const char *kind, PyCapsule_Destructor forget, PyObject *owner)
{
    PyObject *handle = PyCapsule_New(made, kind, forget);
    if (handle && owner && PyCapsule_SetContext(handle, Py_NewRef(owner)) < 0)
        Py_CLEAR(handle);
    return handle;
}

#endif
