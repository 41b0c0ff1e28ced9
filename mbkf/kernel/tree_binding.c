/* A tree behind a capsule, and its functions for Python. Callers are mbkf/kernel/tree.py only, which says what the
 * arguments mean; what is checked here is that no memory is read that is not theirs. */
#include "tree_binding.h"

#include <string.h>

#include "dynamics.h"
#include "manifold.h"
#include "posture.h"
#include "torques.h"

#define CAPSULE "mbkf.kernel.tree"

static void forgotten(PyObject *capsule) { tree_freed(PyCapsule_GetPointer(capsule, CAPSULE)); }

enum { WHOLE_NUMBERS = 4, PER_JOINT = 28 };

/* A joint from its rows of whole numbers and numbers; 0 where it cannot be. */
static int fill(Tree *tree, int i, const int *whole, const double *row)
{
    static const int dofs[] = {6, 3, 1}, numbers_of[] = {7, 4, 1};
    Joint *joint = &tree->joint[i];
    joint->parent = whole[0], joint->kind = whole[1], joint->at_q = whole[2], joint->at_v = whole[3];
    if (joint->parent < 0 || joint->parent >= i || joint->kind < FREE || joint->kind > HINGE)
        return 0;
    joint->dofs = dofs[joint->kind];
    memcpy(joint->axis, row, sizeof joint->axis);
    memcpy(joint->turn, row + 3, sizeof joint->turn);
    memcpy(joint->shift, row + 12, sizeof joint->shift);
    joint->mass = row[15];
    memcpy(joint->lever, row + 16, sizeof joint->lever);
    memcpy(joint->inertia, row + 19, sizeof joint->inertia);
    return joint->at_q >= 0 && joint->at_q + numbers_of[joint->kind] <= tree->nq && joint->at_v >= 0 &&
           joint->at_v + joint->dofs <= tree->nv;
}

/* tree(whole, numbers, gravity, sizes) -> capsule */
static PyObject *py_tree(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *made = NULL;
    (void)self;
    if (!expects(given, 4))
        return NULL;
    const int *whole = array(&held, args[0], PyBUF_C_CONTIGUOUS, sizeof(int), 0);
    const int joints = whole ? length(&held) : 0;
    const double *rows = whole ? numbers(&held, args[1], (Py_ssize_t)joints * PER_JOINT) : NULL;
    const double *gravity = rows ? numbers(&held, args[2], 6) : NULL;
    const int *sizes = gravity ? array(&held, args[3], PyBUF_C_CONTIGUOUS, sizeof(int), 2) : NULL;
    if (sizes && (joints < 2 || held.views[0].len < (Py_ssize_t)sizeof(int) * WHOLE_NUMBERS * joints)) {
        PyErr_SetString(PyExc_ValueError, "a tree needs joints");
        sizes = NULL;
    }
    Tree *tree = sizes ? tree_made(joints, sizes[0], sizes[1]) : NULL;
    if (tree) {
        int sound = 1;
        memcpy(tree->gravity, gravity, sizeof tree->gravity);
        for (int i = 1; i < joints; i++)
            sound = sound && fill(tree, i, whole + WHOLE_NUMBERS * i, rows + PER_JOINT * i);
        if (!sound)
            PyErr_SetString(PyExc_ValueError, "the joints do not make a tree");
        made = sound ? PyCapsule_New(tree, CAPSULE, forgotten) : NULL;
        if (!made)
            tree_freed(tree);
    } else if (sizes)
        PyErr_NoMemory();
    release(&held);
    return made;
}

Tree *tree_in(PyObject *capsule) { return PyCapsule_GetPointer(capsule, CAPSULE); }

/* place(tree, q, frames, jacobian): places of all joints; the Jacobian column by column */
static PyObject *py_place(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    Tree *tree = expects(given, 4) ? tree_in(args[0]) : NULL;
    if (!tree)
        return NULL;
    const double *q = numbers(&held, args[1], tree->nq);
    double *frames = q ? filled(&held, args[2], 12 * tree->joints) : NULL;
    double *jacobian = frames ? filled(&held, args[3], 6 * tree->nv) : NULL;
    if (jacobian) {
        tree_placed(tree, q);
        memcpy(frames, tree->frames, sizeof(double) * 12 * tree->joints);
        memcpy(jacobian, tree->axes, sizeof *tree->axes * tree->nv);
        done = Py_NewRef(Py_None);
    }
    release(&held);
    return done;
}

/* root(tree, q, v, a, wrench, residual, by_state) */
static PyObject *py_root(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    Tree *tree = expects(given, 7) ? tree_in(args[0]) : NULL;
    if (!tree)
        return NULL;
    const double *q = numbers(&held, args[1], tree->nq);
    const double *v = q ? numbers(&held, args[2], tree->nv) : NULL;
    const double *a = v ? numbers(&held, args[3], tree->nv) : NULL;
    const double *wrench = a ? numbers(&held, args[4], 6) : NULL;
    double *residual = wrench ? filled(&held, args[5], 6) : NULL;
    double *by_state = residual ? filled(&held, args[6], 6 * (3 * (Py_ssize_t)tree->nv + 12)) : NULL;
    if (by_state && tree->joint[1].kind != FREE)
        PyErr_SetString(PyExc_ValueError, "the tree has no free root");
    else if (by_state) {
        tree_root(tree, q, v, a, wrench, residual, by_state);
        done = Py_NewRef(Py_None);
    }
    release(&held);
    return done;
}

/* What both functions of torques are given besides a tree: q, v, a, whether dofs move the feet, and wrenches. */
typedef struct {
    const double *q, *v, *a, *wrenches;
    const int *moves;
} Loaded;

static int loaded(Arrays *held, const Tree *tree, PyObject *const *args, Loaded *at)
{
    at->q = numbers(held, args[0], tree->nq);
    at->v = at->q ? numbers(held, args[1], tree->nv) : NULL;
    at->a = at->v ? numbers(held, args[2], tree->nv) : NULL;
    at->moves = at->a ? array(held, args[3], PyBUF_C_CONTIGUOUS, sizeof(int), 2 * (Py_ssize_t)tree->nv) : NULL;
    at->wrenches = at->moves ? numbers(held, args[4], 12) : NULL;
    return at->wrenches != NULL;
}

/* tau(tree, q, v, a, moves, wrenches, tau) */
static PyObject *py_tau(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    Loaded at;
    (void)self;
    Tree *tree = expects(given, 7) ? tree_in(args[0]) : NULL;
    if (!tree)
        return NULL;
    double *tau = loaded(&held, tree, args + 1, &at) ? filled(&held, args[6], tree->nv) : NULL;
    if (tau) {
        tree_tau(tree, at.q, at.v, at.a, at.moves, at.wrenches, tau);
        done = Py_NewRef(Py_None);
    }
    release(&held);
    return done;
}

/* torques(tree, q, v, a, moves, wrenches, tau, by_state, jacobian): matrices column by column */
static PyObject *py_torques(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    Loaded at;
    (void)self;
    Tree *tree = expects(given, 9) ? tree_in(args[0]) : NULL;
    if (!tree)
        return NULL;
    const Py_ssize_t nv = tree->nv;
    double *tau = loaded(&held, tree, args + 1, &at) ? filled(&held, args[6], nv) : NULL;
    double *by_state = tau ? filled(&held, args[7], nv * (3 * nv + 12)) : NULL;
    double *jacobian = by_state ? filled(&held, args[8], 6 * nv) : NULL;
    if (jacobian) {
        tree_torques(tree, at.q, at.v, at.a, at.moves, at.wrenches, tau, by_state);
        memcpy(jacobian, tree->axes, sizeof *tree->axes * nv);
        done = Py_NewRef(Py_None);
    }
    release(&held);
    return done;
}

/* rise(tree, q, joints, rise): how the heights of joints change with q, row by row */
static PyObject *py_rise(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    Tree *tree = expects(given, 4) ? tree_in(args[0]) : NULL;
    if (!tree)
        return NULL;
    const double *q = numbers(&held, args[1], tree->nq);
    const int *joints = q ? array(&held, args[2], PyBUF_C_CONTIGUOUS, sizeof(int), 0) : NULL;
    const int count = joints ? length(&held) : 0;
    double *rise = joints ? filled(&held, args[3], (Py_ssize_t)count * tree->nv) : NULL;
    int sound = rise != NULL;
    for (int n = 0; sound && n < count; n++)
        sound = joints[n] > 0 && joints[n] < tree->joints;
    if (rise && !sound)
        PyErr_SetString(PyExc_ValueError, "the tree has no such joint");
    else if (rise) {
        tree_placed(tree, q);
        for (int n = 0; n < count; n++)
            tree_rise(tree, joints[n], rise + (Py_ssize_t)n * tree->nv);
        done = Py_NewRef(Py_None);
    }
    release(&held);
    return done;
}

/* step(tree, q, step, stepped) */
static PyObject *py_step(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    const Tree *tree = expects(given, 4) ? tree_in(args[0]) : NULL;
    if (!tree)
        return NULL;
    const double *q = numbers(&held, args[1], tree->nq);
    const double *step = q ? numbers(&held, args[2], tree->nv) : NULL;
    double *stepped = step ? filled(&held, args[3], tree->nq) : NULL;
    if (stepped) {
        tree_stepped(tree, q, step, stepped);
        done = Py_NewRef(Py_None);
    }
    release(&held);
    return done;
}

/* step_derivatives(tree, step, by_q, by_step) */
static PyObject *py_step_derivatives(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    const Tree *tree = expects(given, 4) ? tree_in(args[0]) : NULL;
    if (!tree)
        return NULL;
    const double *step = numbers(&held, args[1], tree->nv);
    double *by_q = step ? filled(&held, args[2], (Py_ssize_t)tree->nv * tree->nv) : NULL;
    double *by_step = by_q ? filled(&held, args[3], (Py_ssize_t)tree->nv * tree->nv) : NULL;
    if (by_step) {
        tree_step_derivatives(tree, step, by_q, by_step);
        done = Py_NewRef(Py_None);
    }
    release(&held);
    return done;
}

/* deviation(tree, start, q, deviation, jacobian) */
static PyObject *py_deviation(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    const Tree *tree = expects(given, 5) ? tree_in(args[0]) : NULL;
    if (!tree)
        return NULL;
    const double *start = numbers(&held, args[1], tree->nq);
    const double *q = start ? numbers(&held, args[2], tree->nq) : NULL;
    double *deviation = q ? filled(&held, args[3], tree->nv) : NULL;
    double *jacobian = deviation ? filled(&held, args[4], (Py_ssize_t)tree->nv * tree->nv) : NULL;
    if (jacobian) {
        tree_deviation(tree, start, q, deviation, jacobian);
        done = Py_NewRef(Py_None);
    }
    release(&held);
    return done;
}

/* posture(tree, residual, jacobian, weights, matrix, vector) */
static PyObject *py_posture(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    const Tree *tree = expects(given, 6) ? tree_in(args[0]) : NULL;
    if (!tree)
        return NULL;
    const Py_ssize_t nv = tree->nv;
    const double *residual = numbers(&held, args[1], nv);
    const double *jacobian = residual ? numbers(&held, args[2], nv * nv) : NULL;
    const double *weights = jacobian ? numbers(&held, args[3], nv) : NULL;
    double *matrix = weights ? filled(&held, args[4], nv * nv) : NULL;
    double *vector = matrix ? filled(&held, args[5], nv) : NULL;
    if (vector) {
        tree_posture(tree, residual, jacobian, weights, matrix, vector);
        done = Py_NewRef(Py_None);
    }
    release(&held);
    return done;
}

/* beyond(tree, deviation, lower, upper, beyond) -> how many */
static PyObject *py_beyond(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    const Tree *tree = expects(given, 5) ? tree_in(args[0]) : NULL;
    if (!tree)
        return NULL;
    const double *deviation = numbers(&held, args[1], tree->nv);
    const double *lower = deviation ? numbers(&held, args[2], tree->nv) : NULL;
    const double *upper = lower ? numbers(&held, args[3], tree->nv) : NULL;
    double *beyond = upper ? filled(&held, args[4], tree->nv) : NULL;
    if (beyond)
        done = PyLong_FromLong(tree_beyond(tree, deviation, lower, upper, beyond));
    release(&held);
    return done;
}

PyMethodDef tree_functions[] = {
    {"tree", QUICK(py_tree), "A body as a tree of joints."},
    {"place", QUICK(py_place), "Frames and Jacobian of a tree."},
    {"root", QUICK(py_root), "The root's equations of motion."},
    {"tau", QUICK(py_tau), "Generalised forces under loads."},
    {"torques", QUICK(py_torques), "The same with derivatives."},
    {"rise", QUICK(py_rise), "How heights of joints change."},
    {"step", QUICK(py_step), "A configuration, one step further."},
    {"step_derivatives", QUICK(py_step_derivatives), "Derivatives of a step."},
    {"deviation", QUICK(py_deviation), "Turns of a tree's joints from another configuration."},
    {"posture", QUICK(py_posture), "Information of readings of turns."},
    {"beyond", QUICK(py_beyond), "How far turns lie beyond limits."},
    {NULL, NULL, 0, NULL},
};
