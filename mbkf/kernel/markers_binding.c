/* Markers, for Python. Callers are mbkf/kernel/markers.py only, which says what the arguments mean; what is checked
 * here is that no memory is read that is not theirs. */
#include "markers_binding.h"

#include <string.h>

#include "markers.h"
#include "tree_binding.h"

/* Joints (count) of the markers, taken as the next array; 0 with an error set where one is not the tree's. */
static int taken(Arrays *held, const Tree *tree, PyObject *joints, Markers *markers)
{
    markers->joint = array(held, joints, PyBUF_C_CONTIGUOUS, sizeof(int), 0);
    markers->count = markers->joint ? length(held) : 0;
    for (int m = 0; m < markers->count; m++)
        if (markers->joint[m] < 0 || markers->joint[m] >= tree->joints) {
            PyErr_SetString(PyExc_ValueError, "a marker's joint is not the tree's");
            return 0;
        }
    return markers->joint != NULL;
}

/* marker_places(tree, joints, local, q, places, jacobian): the tree placed, too; the Jacobian column by column */
static PyObject *py_marker_places(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    Markers markers;
    PyObject *done = NULL;
    (void)self;
    Tree *tree = expects(given, 6) ? tree_in(args[0]) : NULL;
    if (!tree)
        return NULL;
    const int sound = taken(&held, tree, args[1], &markers);
    markers.local = sound ? numbers(&held, args[2], 3 * (Py_ssize_t)markers.count) : NULL;
    const double *q = markers.local ? numbers(&held, args[3], tree->nq) : NULL;
    double *places = q ? filled(&held, args[4], 3 * (Py_ssize_t)markers.count) : NULL;
    double *jacobian = places ? filled(&held, args[5], 6 * (Py_ssize_t)tree->nv) : NULL;
    if (jacobian) {
        tree_placed(tree, q);
        markers_placed(tree, &markers, places);
        memcpy(jacobian, tree->axes, sizeof *tree->axes * tree->nv);
        done = Py_NewRef(Py_None);
    }
    release(&held);
    return done;
}

/* markers_apart(measured, places, radius, innovation, squared, seen) -> how many are seen; -1: one is not near */
static PyObject *py_markers_apart(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    if (!expects(given, 6))
        return NULL;
    const double radius = PyFloat_AsDouble(args[2]);
    const double *measured = PyErr_Occurred() ? NULL : numbers(&held, args[0], 0);
    const Py_ssize_t count = measured ? length(&held) : 0;
    const int whole = measured && held.views[0].len == (Py_ssize_t)sizeof(double) * 3 * count;
    if (measured && !whole)
        PyErr_SetString(PyExc_ValueError, "markers have three coordinates");
    const double *places = whole ? numbers(&held, args[1], 3 * count) : NULL;
    double *innovation = places ? filled(&held, args[3], 3 * count) : NULL;
    double *squared = innovation ? filled(&held, args[4], count) : NULL;
    char *seen = squared ? array(&held, args[5], PyBUF_ANY_CONTIGUOUS | PyBUF_WRITABLE, 1, count) : NULL;
    if (seen)
        done = PyLong_FromLong(markers_apart((int)count, measured, places, radius, innovation, squared, seen));
    release(&held);
    return done;
}

/* marker_information(tree, joints, weights, trusted, jacobian, places, innovation, matrix, vector) -> y' R^-1 y */
static PyObject *py_marker_information(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    Markers markers;
    PyObject *done = NULL;
    (void)self;
    Tree *tree = expects(given, 9) ? tree_in(args[0]) : NULL;
    if (!tree)
        return NULL;
    const int sound = taken(&held, tree, args[1], &markers);
    const Py_ssize_t count = sound ? markers.count : 0, nv = tree->nv;
    const double *weights = sound ? numbers(&held, args[2], count) : NULL;
    const char *trusted = weights ? array(&held, args[3], PyBUF_C_CONTIGUOUS, 1, count) : NULL;
    const double *axes = trusted ? array(&held, args[4], PyBUF_F_CONTIGUOUS, sizeof(double), 6 * nv) : NULL;
    const double *places = axes ? numbers(&held, args[5], 3 * count) : NULL;
    const double *innovation = places ? numbers(&held, args[6], 3 * count) : NULL;
    double *matrix = innovation ? filled(&held, args[7], nv * nv) : NULL;
    double *vector = matrix ? filled(&held, args[8], nv) : NULL;
    if (vector)
        done = PyFloat_FromDouble(
            markers_information(tree, &markers, weights, trusted, axes, places, innovation, matrix, vector));
    release(&held);
    return done;
}

PyMethodDef marker_functions[] = {
    {"marker_places", QUICK(py_marker_places), "Places of markers at a configuration, and the tree's Jacobian."},
    {"markers_apart", QUICK(py_markers_apart), "Innovations of markers, and whether all of them are near."},
    {"marker_information", QUICK(py_marker_information), "What markers say of the configuration."},
    {NULL, NULL, 0, NULL},
};
