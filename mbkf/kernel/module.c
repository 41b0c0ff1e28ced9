/* The Python module mbkf.kernel._kernel: arrays in, arrays filled. Callers are mbkf/kernel/__init__.py only, which
 * says what the arguments mean; what is checked here is that no memory is read that is not theirs. */
#include "arrays.h"

#include <stdlib.h>
#include <string.h>

#include "blas.h"
#include "covariance.h"
#include "product.h"
#include "contact_binding.h"
#include "tree_binding.h"

Blas blas;

/* Memory to work in; it stays from call to call, since fresh pages cost more than the work. The interpreter's lock is
 * held meanwhile. */
static double *workspace(long count)
{
    static double *memory;
    static long size;
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
            carry(nv, N, P, A, B, joints, n_joints, &s, noise, sd, carried, work);
            done = Py_NewRef(Py_None);
        }
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
        carry_velocities(nv, P, A, B, joints, n_joints, dt, noise, carried, work);
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
        else if (is_square(&held.views[0], N) && is_square(&held.views[1], n))
            done = PyLong_FromLong(inform(N, P, n, information, m, rows, informed, work));
    }
    release(&held);
    return done;
}

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
    {"carry_velocities", (PyCFunction)(void (*)(void))py_carry_velocities, METH_FASTCALL,
     "The same for positions and velocities alone."},
    {"inform", (PyCFunction)(void (*)(void))py_inform, METH_FASTCALL, "A covariance after readings."},
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
    if (module && (PyModule_AddFunctions(module, tree_functions) < 0 || PyModule_AddFunctions(module, contact_functions) < 0))
        Py_CLEAR(module);
    return module;
}
