/* Feet behind a capsule, and the decision on them for Python. The caller is mbkf/kernel/contact.py only, which says what
 * the arguments mean; what is checked here is that no memory is read that is not theirs. */
#include "contact_binding.h"

#include <stdlib.h>
#include <string.h>

#include "contact.h"
#include "tree_binding.h"
#include "wrenches.h"

#define CAPSULE "mbkf.kernel.feet"

enum { WHOLE_NUMBERS = 12, PLATE_NUMBERS = sizeof(Plate) / sizeof(double), LIMITS = sizeof(Limits) / sizeof(double) };
enum { PLACES = 3 * FEET * SOLE, NUMBERS = PLACES + 2 + LIMITS, REST = 25 };

static void freed(Feet *feet)
{
    free(feet->plate);
    free(feet);
}

static void forgotten(PyObject *capsule)
{
    PyObject *tree = PyCapsule_GetContext(capsule);
    freed(PyCapsule_GetPointer(capsule, CAPSULE));
    Py_XDECREF(tree);
}

/* From rows of whole numbers, numbers, and plates; 0 where they do not fit the tree. */
static int filled_in(Feet *feet, const int *whole, const double *row, const double *plates)
{
    const int joints = feet->tree->joints;
    int sound = 1;
    memcpy(feet->joint, whole, sizeof feet->joint);
    memcpy(feet->foot, whole + 6, sizeof feet->foot);
    feet->root = whole[8], feet->window = whole[9], feet->still = whole[10], feet->fall = whole[11];
    for (int i = 0; i < 9; i++)
        sound = sound && whole[i] > 0 && whole[i] < joints;
    memcpy(feet->place, row, sizeof feet->place);
    feet->floor_m = row[PLACES], feet->dt_s = row[PLACES + 1];
    memcpy(&feet->limits, row + PLACES + 2, sizeof feet->limits);
    memcpy(feet->plate, plates, sizeof *feet->plate * feet->plates);
    return sound && feet->window > 0 && feet->still > 0 && feet->fall > 3 && feet->tree->joint[1].kind == FREE;
}

/* feet(tree, whole, numbers, plates) -> capsule */
static PyObject *py_feet(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *made = NULL;
    (void)self;
    Tree *tree = expects(given, 4) ? tree_in(args[0]) : NULL;
    if (!tree)
        return NULL;
    const int *whole = array(&held, args[1], PyBUF_C_CONTIGUOUS, sizeof(int), WHOLE_NUMBERS);
    const double *row = whole ? numbers(&held, args[2], NUMBERS) : NULL;
    const double *plates = row ? numbers(&held, args[3], 0) : NULL;
    const int count = plates ? length(&held) : 0;
    if (plates && held.views[2].len != (Py_ssize_t)sizeof(Plate) * count) {
        PyErr_SetString(PyExc_ValueError, "a plate has another number of numbers");
        plates = NULL;
    }
    Feet *feet = plates ? calloc(1, sizeof *feet) : NULL;
    if (feet) {
        feet->tree = tree, feet->plates = count;
        feet->plate = calloc(count + 1, sizeof *feet->plate);
        if (!feet->plate)
            PyErr_NoMemory();
        else if (!filled_in(feet, whole, row, plates))
            PyErr_SetString(PyExc_ValueError, "the feet do not fit the tree");
        else
            made = PyCapsule_New(feet, CAPSULE, forgotten);
        if (!made)
            freed(feet);
        else if (PyCapsule_SetContext(made, args[0]) == 0)
            Py_INCREF(args[0]);
        else
            Py_CLEAR(made);
    } else if (plates)
        PyErr_NoMemory();
    release(&held);
    return made;
}

/* Whether a record's counts stay within it. */
static int is_record(const Feet *feet, const double *record)
{
    for (int i = FRAMES; i < HEAD; i++)
        if (!(record[i] >= 0.0 && record[i] <= (i == FRAMES ? feet->window : record[FRAMES])))
            return 0;
    return 1;
}

/* stand(feet, q, v, a, plates, supported, before, after, wrench, middles, below, rest) -> flags */
static PyObject *py_stand(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    const Feet *feet = expects(given, 12) ? PyCapsule_GetPointer(args[0], CAPSULE) : NULL;
    const int supported = feet ? PyObject_IsTrue(args[5]) : -1;
    if (supported < 0)
        return NULL;
    Seen seen = {.supported = supported};
    Told told = {.wrench = NULL};
    seen.q = numbers(&held, args[1], feet->tree->nq);
    seen.v = seen.q ? numbers(&held, args[2], feet->tree->nv) : NULL;
    seen.a = seen.v ? numbers(&held, args[3], feet->tree->nv) : NULL;
    seen.wrench = seen.a ? numbers(&held, args[4], 6 * (Py_ssize_t)feet->plates) : NULL;
    const double *before = seen.wrench ? numbers(&held, args[6], record_length(feet)) : NULL;
    double *after = before ? filled(&held, args[7], record_length(feet)) : NULL;
    told.wrench = after ? filled(&held, args[8], 12) : NULL;
    told.middles = told.wrench ? filled(&held, args[9], 6) : NULL;
    told.below = told.middles ? filled(&held, args[10], 6) : NULL;
    told.rest = told.below ? filled(&held, args[11], REST) : NULL;
    if (told.rest && !is_record(feet, before))
        PyErr_SetString(PyExc_ValueError, "the memory is none of these feet");
    else if (told.rest)
        done = PyLong_FromLong(contact_decided(feet, &seen, before, after, &told));
    release(&held);
    return done;
}

/* wrench_rows(middles, right, left, expected, w, first, rows, values) */
static PyObject *py_wrench_rows(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    const int first = expects(given, 8) ? PyObject_IsTrue(args[5]) : -1;
    if (first < 0)
        return NULL;
    const double *middles = numbers(&held, args[0], 6);
    const double *right = middles ? numbers(&held, args[1], 6) : NULL;
    const double *left = right ? numbers(&held, args[2], 6) : NULL;
    const double *expected = left ? numbers(&held, args[3], 12) : NULL;
    const double *w = expected ? numbers(&held, args[4], 12) : NULL;
    double *rows = w ? array(&held, args[6], PyBUF_C_CONTIGUOUS | PyBUF_WRITABLE, sizeof(double), 144) : NULL;
    double *values = rows ? filled(&held, args[7], 12) : NULL;
    if (values) {
        wrench_rows(middles, (const double *const[]){right, left}, expected, w, first, rows, values);
        done = Py_NewRef(Py_None);
    }
    release(&held);
    return done;
}

/* wrench_walk(P, at, middles, sd, belt) */
static PyObject *py_wrench_walk(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    const long at = expects(given, 5) ? PyLong_AsLong(args[1]) : -1;
    if (PyErr_Occurred())
        return NULL;
    double *P = filled(&held, args[0], 0);
    const int N = P ? length(&held) : 0;
    const double *middles = P ? numbers(&held, args[2], 6) : NULL;
    const double *sd = middles ? numbers(&held, args[3], 2) : NULL;
    const double *belt = sd ? numbers(&held, args[4], 2) : NULL;
    if (belt && (at < 0 || at + 12 > N || held.views[0].len != (Py_ssize_t)sizeof(double) * N * N))
        PyErr_SetString(PyExc_ValueError, "the covariance has no such wrenches");
    else if (belt) {
        wrench_walk(P, N, (int)at, middles, sd, belt);
        done = Py_NewRef(Py_None);
    }
    release(&held);
    return done;
}

/* wrenches_possible(readings, reach, limits) -> whether all are */
static PyObject *py_wrenches_possible(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    if (!expects(given, 3))
        return NULL;
    const double *readings = numbers(&held, args[0], 0);
    const double *reach = readings ? numbers(&held, args[1], 1) : NULL;
    const int plates = reach ? length(&held) : 0;
    const double *limits = reach ? numbers(&held, args[2], 5) : NULL;
    if (limits) {
        const Possible possible = {limits[0], limits[1], limits[2], limits[3], limits[4]};
        const long count = (long)(held.views[0].len / (Py_ssize_t)sizeof(double) / 6);
        done = PyBool_FromLong(wrenches_possible(count, readings, plates, reach, &possible));
    }
    release(&held);
    return done;
}

/* wrench_means(ring, first, weights, width, origins, means) */
static PyObject *py_wrench_means(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    const long first = expects(given, 6) ? PyLong_AsLong(args[1]) : -1;
    const double width = PyErr_Occurred() ? 0.0 : PyFloat_AsDouble(args[3]);
    if (PyErr_Occurred())
        return NULL;
    const double *ring = numbers(&held, args[0], 0);
    const int rows = ring ? length(&held) : 0;
    const double *weights = ring ? numbers(&held, args[2], 0) : NULL;
    const int n = weights ? length(&held) : 0;
    const double *origins = weights ? numbers(&held, args[4], 0) : NULL;
    const int plates = origins ? length(&held) : 0;
    double *means = origins ? filled(&held, args[5], 6 * (Py_ssize_t)plates) : NULL;
    if (means && (first < 0 || held.views[0].len != (Py_ssize_t)sizeof(double) * 6 * rows * plates || !rows))
        PyErr_SetString(PyExc_ValueError, "the ring has no such readings");
    else if (means) {
        wrench_means(ring, rows, plates, first, n, weights, width, origins, means);
        done = Py_NewRef(Py_None);
    }
    release(&held);
    return done;
}

PyMethodDef contact_functions[] = {
    {"feet", (PyCFunction)(void (*)(void))py_feet, METH_FASTCALL, "Feet of a tree, and plates that they stand on."},
    {"stand", (PyCFunction)(void (*)(void))py_stand, METH_FASTCALL, "What the feet stand on in one frame."},
    {"wrench_rows", (PyCFunction)(void (*)(void))py_wrench_rows, METH_FASTCALL, "Readings of the feet's wrenches."},
    {"wrench_walk", (PyCFunction)(void (*)(void))py_wrench_walk, METH_FASTCALL, "Random walks of the feet's wrenches."},
    {"wrench_means", (PyCFunction)(void (*)(void))py_wrench_means, METH_FASTCALL, "Means of readings over a window."},
    {"wrenches_possible", (PyCFunction)(void (*)(void))py_wrenches_possible, METH_FASTCALL,
     "Whether a person can make plates read this."},
    {NULL, NULL, 0, NULL},
};
