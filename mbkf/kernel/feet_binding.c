/* Feet, for Python. Callers are mbkf/kernel/feet.py only, which says what the arguments mean; what is checked here is
 * that no memory is read that is not theirs. */
#include "feet_binding.h"

#include <string.h>

#include "feet.h"
#include "tree_binding.h"

/* ((x, y, z) of heel, ball and toe end) of both feet */
static PyObject *vectors(double of[2][SOLE_POINTS][3])
{
    double *r = of[0][0], *l = of[1][0];
    return Py_BuildValue("(((ddd)(ddd)(ddd))((ddd)(ddd)(ddd)))", r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8],
                         l[0], l[1], l[2], l[3], l[4], l[5], l[6], l[7], l[8]);
}

/* The lowest of some first points of a sole. */
static int lowest(const double points[SOLE_POINTS][3], int first)
{
    int found = 0;
    for (int k = 1; k < first; k++)
        if (points[k][2] < points[found][2])
            found = k;
    return found;
}

/* feet(tree, joints, local, q, v, middles) -> (points, velocities, up, root, lowest of three, lowest of the first two);
 * the tree placed, too */
static PyObject *py_feet(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    Soles soles;
    Feet feet;
    (void)self;
    Tree *tree = expects(given, 6) ? tree_in(args[0]) : NULL;
    if (!tree)
        return NULL;
    const int *joints = array(&held, args[1], PyBUF_C_CONTIGUOUS, sizeof(int), 3);
    for (int k = 0; joints && k < 3; k++)
        if (joints[k] < 0 || joints[k] >= tree->joints) {
            PyErr_SetString(PyExc_ValueError, "a foot's joint is not the tree's");
            joints = NULL;
        }
    const double *local = joints ? numbers(&held, args[2], 6 * SOLE_POINTS) : NULL;
    const double *q = local ? numbers(&held, args[3], tree->nq) : NULL;
    const double *v = q ? numbers(&held, args[4], tree->nv) : NULL;
    double *middles = v ? filled(&held, args[5], 6) : NULL;
    if (middles) {
        memcpy(soles.foot, joints, sizeof soles.foot);
        memcpy(soles.local, local, sizeof soles.local);
        soles.root = joints[2];
        tree_placed(tree, q);
        feet_at(tree, &soles, v, &feet);
        memcpy(middles, feet.middles, sizeof feet.middles);
        PyObject *points = vectors(feet.points), *velocities = vectors(feet.velocities);
        if (points && velocities)
            done = Py_BuildValue(
                "(OO(dd)(ddd)(ii)(ii))", points, velocities, feet.up[0], feet.up[1], feet.root[0], feet.root[1],
                feet.root[2], lowest((const double(*)[3])feet.points[0], SOLE_POINTS),
                lowest((const double(*)[3])feet.points[1], SOLE_POINTS), lowest((const double(*)[3])feet.points[0], 2),
                lowest((const double(*)[3])feet.points[1], 2));
        Py_XDECREF(points);
        Py_XDECREF(velocities);
    }
    release(&held);
    return done;
}

/* foot_rows(centres, weights, expected, w, first, rows, values) */
static PyObject *py_foot_rows(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    double centres[2][3], weights[2][6];
    (void)self;
    if (!expects(given, 7))
        return NULL;
    const long first = PyLong_AsLong(args[4]);
    const double *about = PyErr_Occurred() ? NULL : numbers(&held, args[0], 6);
    const double *weight = about ? numbers(&held, args[1], 12) : NULL;
    const double *expected = weight ? numbers(&held, args[2], 12) : NULL;
    const double *w = expected ? numbers(&held, args[3], 12) : NULL;
    double *rows = w ? filled(&held, args[5], 144) : NULL;
    double *values = rows ? filled(&held, args[6], 12) : NULL;
    if (values && (first < 0 || first > 1))
        PyErr_SetString(PyExc_ValueError, "a foot is 0 or 1");
    else if (values) {
        memcpy(centres, about, sizeof centres);
        memcpy(weights, weight, sizeof weights);
        foot_rows((const double(*)[3])centres, (const double(*)[6])weights, expected, w, (int)first, rows, values);
        done = Py_NewRef(Py_None);
    }
    release(&held);
    return done;
}

/* foot_walks(centres, sd, first, P): in place */
static PyObject *py_foot_walks(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    double centres[2][3];
    (void)self;
    if (!expects(given, 4))
        return NULL;
    const long first = PyLong_AsLong(args[2]);
    const double *about = PyErr_Occurred() ? NULL : numbers(&held, args[0], 6);
    const double *sd = about ? numbers(&held, args[1], 6) : NULL;
    double *P = sd ? filled(&held, args[3], 0) : NULL;
    const Py_ssize_t N = P ? length(&held) : 0;
    if (P && (first < 0 || first + 12 > N || held.views[2].len != (Py_ssize_t)sizeof(double) * N * N))
        PyErr_SetString(PyExc_ValueError, "the wrenches are not in the covariance");
    else if (P) {
        memcpy(centres, about, sizeof centres);
        foot_walks((const double(*)[3])centres, sd, (int)first, (int)N, P);
        done = Py_NewRef(Py_None);
    }
    release(&held);
    return done;
}

PyMethodDef feet_functions[] = {
    {"feet", QUICK(py_feet), "Soles of both feet, and how they move."},
    {"foot_rows", QUICK(py_foot_rows), "Rows on both feet's wrenches."},
    {"foot_walks", QUICK(py_foot_walks), "The random walk of both feet's wrenches."},
    {NULL, NULL, 0, NULL},
};
