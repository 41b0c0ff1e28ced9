/* The Python module mbkf.kernel._kernel: arrays in, arrays filled. Callers are mbkf/kernel/__init__.py only, which
 * says what the arguments mean; what is checked here is that no memory is read that is not theirs. */
#include "arrays.h"

#include <stdlib.h>
#include <string.h>

#include "blas.h"
#include "covariance.h"
#include "differences.h"
#include "manifold.h"
#include "markers_binding.h"
#include "orientation_binding.h"
#include "product.h"
#include "contact_binding.h"
#include "tree_binding.h"

#if defined(_MSC_VER)
#define THREAD_LOCAL __declspec(thread)
#else
#define THREAD_LOCAL _Thread_local
#endif

Blas blas;

/* Each thread's memory to work in; it stays from call to call, since fresh pages cost more than the work. What takes
 * tens of microseconds runs without the interpreter's lock, so that a stream is read meanwhile. */
static double *workspace(long count)
{
    static THREAD_LOCAL double *memory;
    static THREAD_LOCAL long size;
    if (count > size) {
        double *larger = realloc(memory, sizeof(double) * count);
        if (!larger) {
            PyErr_NoMemory();
            return NULL;
        }
        memory = larger;
        size = count;
    }
    return memory;
}

/* Whether a view has the numbers of a square of some size; an error is set if not. */
static int is_square(const Py_buffer *view, Py_ssize_t size)
{
    if (view->len == (Py_ssize_t)sizeof(double) * size * size)
        return 1;
    PyErr_SetString(PyExc_ValueError, "the arrays' sizes do not fit");
    return 0;
}

/* Whether joints (n x 2), taken last, name dofs below nv; an error is set if not. */
static int are_joints(const Arrays *held, const int *joints, int n, int nv)
{
    int sound = held->views[held->held - 1].len >= (Py_ssize_t)(2 * sizeof(int)) * n;
    for (int k = 0; sound && k < n; k++)
        sound = joints[2 * k] >= 0 && joints[2 * k + 1] >= 0 && joints[2 * k] + joints[2 * k + 1] <= nv;
    if (!sound)
        PyErr_SetString(PyExc_ValueError, "the joints' dofs are not the state's");
    return sound;
}

/* carry(P, A, B, joints, singer, noise, sd, carried) */
static PyObject *py_carry(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    if (!expects(given, 8))
        return NULL;
    const double *sd = numbers(&held, args[6], 0);
    const int nv = sd ? length(&held) : 0;
    const double *P = sd ? symmetric(&held, args[0], 0) : NULL;
    const int N = P ? length(&held) : 0;
    const double *A = P ? numbers(&held, args[1], (Py_ssize_t)nv * nv) : NULL;
    const double *B = A ? numbers(&held, args[2], (Py_ssize_t)nv * nv) : NULL;
    const int *joints = B ? array(&held, args[3], PyBUF_C_CONTIGUOUS, sizeof(int), 0) : NULL;
    const int n_joints = joints ? length(&held) : 0;
    if (joints && !are_joints(&held, joints, n_joints, nv))
        joints = NULL;
    const double *singer = joints ? numbers(&held, args[4], 4) : NULL;
    const double *noise = singer ? numbers(&held, args[5], 9) : NULL;
    double *carried = noise ? filled(&held, args[7], (Py_ssize_t)N * N) : NULL;
    double *work = carried ? workspace(carry_work(nv, N)) : NULL;
    if (work) {
        if (N < 3 * nv)
            PyErr_SetString(PyExc_ValueError, "the covariance is smaller than the state");
        else if (is_square(&held.views[1], N)) {
            const Singer s = {singer[0], singer[1], singer[2], singer[3]};
            Py_BEGIN_ALLOW_THREADS
            carry(nv, N, P, A, B, joints, n_joints, &s, noise, sd, carried, work);
            Py_END_ALLOW_THREADS
            done = Py_NewRef(Py_None);
        }
    }
    release(&held);
    return done;
}

/* predict(tree, P, q, v, a, joints, singer, noise, sd, carried, q2, v2, a2): mean and covariance one step later */
static PyObject *py_predict(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    const Tree *tree = expects(given, 13) ? tree_in(args[0]) : NULL;
    if (!tree)
        return NULL;
    const int nv = tree->nv;
    const double *P = symmetric(&held, args[1], 3 * (Py_ssize_t)nv);
    const int N = P ? length(&held) : 0;
    const double *q = P ? numbers(&held, args[2], tree->nq) : NULL;
    const double *v = q ? numbers(&held, args[3], nv) : NULL;
    const double *a = v ? numbers(&held, args[4], nv) : NULL;
    const int *joints = a ? array(&held, args[5], PyBUF_C_CONTIGUOUS, sizeof(int), 0) : NULL;
    const int n_joints = joints ? length(&held) : 0;
    if (joints && !are_joints(&held, joints, n_joints, nv))
        joints = NULL;
    const double *singer = joints ? numbers(&held, args[6], 4) : NULL;
    const double *noise = singer ? numbers(&held, args[7], 9) : NULL;
    const double *sd = noise ? numbers(&held, args[8], nv) : NULL;
    double *carried = sd ? filled(&held, args[9], (Py_ssize_t)N * N) : NULL;
    double *q2 = carried ? filled(&held, args[10], tree->nq) : NULL;
    double *v2 = q2 ? filled(&held, args[11], nv) : NULL;
    double *a2 = v2 ? filled(&held, args[12], nv) : NULL;
    double *work = a2 ? workspace(nv + 2L * nv * nv + carry_work(nv, N)) : NULL;
    if (work && is_square(&held.views[0], N)) {
        double *step = work, *A = work + nv, *B = A + (long)nv * nv;
        const Singer s = {singer[0], singer[1], singer[2], singer[3]};
        for (int i = 0; i < nv; i++) {
            step[i] = s.dt * v[i] + s.c2 * a[i];
            v2[i] = v[i] + s.c1 * a[i];
            a2[i] = s.rho * a[i];
        }
        tree_stepped(tree, q, step, q2);
        tree_step_derivatives(tree, step, A, B);
        Py_BEGIN_ALLOW_THREADS
        carry(nv, N, P, A, B, joints, n_joints, &s, noise, sd, carried, B + (long)nv * nv);
        Py_END_ALLOW_THREADS
        done = Py_NewRef(Py_None);
    }
    release(&held);
    return done;
}

/* carry_velocities(P, A, B, joints, dt, noise, carried) */
static PyObject *py_carry_velocities(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    if (!expects(given, 7))
        return NULL;
    const double dt = PyFloat_AsDouble(args[4]);
    const double *A = PyErr_Occurred() ? NULL : numbers(&held, args[1], 0);
    const int nv = A ? length(&held) : 0, N = 2 * nv;
    const double *B = A ? numbers(&held, args[2], (Py_ssize_t)nv * nv) : NULL;
    const double *P = B ? symmetric(&held, args[0], N) : NULL;
    const int *joints = P ? array(&held, args[3], PyBUF_C_CONTIGUOUS, sizeof(int), 0) : NULL;
    const int n_joints = joints ? length(&held) : 0;
    if (joints && !are_joints(&held, joints, n_joints, nv))
        joints = NULL;
    const double *noise = joints ? numbers(&held, args[5], 4 * (Py_ssize_t)nv) : NULL;
    double *carried = noise ? filled(&held, args[6], (Py_ssize_t)N * N) : NULL;
    double *work = carried ? workspace(carry_work(nv, N)) : NULL;
    if (work) {
        Py_BEGIN_ALLOW_THREADS
        carry_velocities(nv, P, A, B, joints, n_joints, dt, noise, carried, work);
        Py_END_ALLOW_THREADS
        done = Py_NewRef(Py_None);
    }
    release(&held);
    return done;
}

/* inform(P, information, rows, informed) -> 0, or which factorisation failed */
static PyObject *py_inform(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    if (!expects(given, 4))
        return NULL;
    const double *P = symmetric(&held, args[0], 0);
    const int N = P ? length(&held) : 0;
    const double *information = P ? symmetric(&held, args[1], 0) : NULL;
    const int n = information ? length(&held) : 0;
    const double *rows = information ? numbers(&held, args[2], 0) : NULL;
    const int m = rows ? length(&held) : 0;
    double *informed = rows ? filled(&held, args[3], (Py_ssize_t)N * N) : NULL;
    double *work = informed ? workspace(inform_work(n, m, N)) : NULL;
    if (work) {
        if (n > N || (m && held.views[2].len != (Py_ssize_t)sizeof(double) * m * N))
            PyErr_SetString(PyExc_ValueError, "the arrays' sizes do not fit");
        else if (is_square(&held.views[0], N) && is_square(&held.views[1], n)) {
            int failed;
            Py_BEGIN_ALLOW_THREADS
            failed = inform(N, P, n, information, m, rows, informed, work);
            Py_END_ALLOW_THREADS
            done = PyLong_FromLong(failed);
        }
    }
    release(&held);
    return done;
}

/* correction(P, vector, rows, values, step): step = P (vector on the first components + rows' values) */
static PyObject *py_correction(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    (void)self;
    if (!expects(given, 5))
        return NULL;
    const double *P = symmetric(&held, args[0], 0);
    const int N = P ? length(&held) : 0;
    const double *vector = P ? numbers(&held, args[1], 0) : NULL;
    const int n = vector ? length(&held) : 0;
    const double *values = vector ? numbers(&held, args[3], 0) : NULL;
    const int m = values ? length(&held) : 0;
    const double *rows = values ? numbers(&held, args[2], (Py_ssize_t)m * N) : NULL;
    double *step = rows ? filled(&held, args[4], N) : NULL;
    double *total = step ? workspace(N) : NULL;
    if (total && n > N)
        PyErr_SetString(PyExc_ValueError, "the arrays' sizes do not fit");
    else if (total && is_square(&held.views[0], N)) {
        correction(N, P, n, vector, m, rows, values, step, total);
        done = Py_NewRef(Py_None);
    }
    release(&held);
    return done;
}

/* third_differences(first, second, third, latest, level) -> (known, below) */
static PyObject *py_third_differences(PyObject *self, PyObject *const *args, Py_ssize_t given)
{
    Arrays held = {.held = 0};
    PyObject *done = NULL;
    const double *samples[4] = {NULL, NULL, NULL, NULL};
    (void)self;
    if (!expects(given, 5))
        return NULL;
    const double level = PyFloat_AsDouble(args[4]);
    Py_ssize_t count = 0;
    for (int k = 0; k < 4 && !PyErr_Occurred(); k++) {
        samples[k] = numbers(&held, args[k], count);
        if (samples[k] && !k)
            count = held.views[0].len / (Py_ssize_t)sizeof(double);
    }
    if (samples[3]) {
        long known, below;
        third_differences((long)count, samples, level, &known, &below);
        done = Py_BuildValue("(ll)", known, below);
    }
    release(&held);
    return done;
}

#include "smoothing_bindings.h"
#include "spread_bindings.h"

/* vectors() -> bits of the vectors that products are made with; 0 where BLAS makes them */
static PyObject *py_vectors(PyObject *self, PyObject *nothing)
{
    (void)self;
    (void)nothing;
    return PyLong_FromLong(product_is_own() ? 512 : 0);
}

/* choose(own): products by instructions of their own, where the processor has them, or by BLAS */
static PyObject *py_choose(PyObject *self, PyObject *own)
{
    (void)self;
    const int wanted = PyObject_IsTrue(own);
    if (wanted < 0)
        return NULL;
    product_choose(wanted);
    return Py_NewRef(Py_None);
}

/* The routine of a capsule of SciPy's, where its arguments are what we take them to be. */
static void *routine(PyObject *capsules, const char *name, const char *begins)
{
    PyObject *capsule = PyDict_GetItemString(capsules, name);
    const char *signature = capsule ? PyCapsule_GetName(capsule) : NULL;
    if (!signature || strncmp(signature, begins, strlen(begins)) != 0) {
        PyErr_Format(PyExc_ImportError, "SciPy offers no %s as it is known here", name);
        return NULL;
    }
    return PyCapsule_GetPointer(capsule, signature);
}

/* connect(capsules): takes BLAS and LAPACK routines from SciPy's, by name */
static PyObject *py_connect(PyObject *self, PyObject *capsules)
{
    (void)self;
    if (!PyDict_Check(capsules)) {
        PyErr_SetString(PyExc_TypeError, "a dictionary of capsules is needed");
        return NULL;
    }
    void *dgemm = routine(capsules, "dgemm", "void (char *, char *, int *, int *, int *, ");
    void *dsyrk = dgemm ? routine(capsules, "dsyrk", "void (char *, char *, int *, int *, ") : NULL;
    void *dtrsm = dsyrk ? routine(capsules, "dtrsm", "void (char *, char *, char *, char *, int *, int *, ") : NULL;
    void *dpotrf = dtrsm ? routine(capsules, "dpotrf", "void (char *, int *, ") : NULL;
    if (!dpotrf)
        return NULL;
    memcpy(&blas.dgemm, &dgemm, sizeof dgemm);
    memcpy(&blas.dsyrk, &dsyrk, sizeof dsyrk);
    memcpy(&blas.dtrsm, &dtrsm, sizeof dtrsm);
    memcpy(&blas.dpotrf, &dpotrf, sizeof dpotrf);
    return Py_NewRef(Py_None);
}

static PyMethodDef methods[] = {
    {"connect", py_connect, METH_O, "Takes BLAS and LAPACK routines from a dictionary of capsules."},
    {"carry", (PyCFunction)(void (*)(void))py_carry, METH_FASTCALL, "A covariance, one step later."},
    {"predict", QUICK(py_predict), "A state and its covariance, one step later."},
    {"carry_velocities", (PyCFunction)(void (*)(void))py_carry_velocities, METH_FASTCALL,
     "The same for positions and velocities alone."},
    {"inform", (PyCFunction)(void (*)(void))py_inform, METH_FASTCALL, "A covariance after readings."},
    {"correction", QUICK(py_correction), "The step of a mean that readings make."},
    {"third_differences", QUICK(py_third_differences), "How many third differences lie below a level."},
    SMOOTHING_METHODS,
    SPREAD_METHODS,
    {"choose", py_choose, METH_O, "Products by instructions of their own, where they can be, or by BLAS."},
    {"vectors", py_vectors, METH_NOARGS, "Bits of the vectors that products are made with; 0: BLAS makes them."},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "mbkf.kernel._kernel", "Compiled arithmetic of a filter's step.", -1, methods,
    NULL,                  NULL,                  NULL,                                      NULL,
};

PyMODINIT_FUNC PyInit__kernel(void)
{
    PyObject *module = PyModule_Create(&definition);
    PyMethodDef *const further[] = {tree_functions, marker_functions, contact_functions, orientation_functions};
    for (int k = 0; module && k < 4; k++)
        if (PyModule_AddFunctions(module, further[k]) < 0)
            Py_CLEAR(module);
    return module;
}
