/* The Python module mbkf.kernel._kernel: the functions that *_functions.py declare, and BLAS and LAPACK for them. */
#include "arguments.h"

#include <string.h>

#include "blas.h"
#include "binding.h" /* made by .ci/kernel_binding.py */

Blas blas;

/* The routine in a capsule of SciPy's, if its signature begins as we call it. */
static void *routine(PyObject *capsules, const char *name, const char *begins)
{
    PyObject *capsule = PyDict_GetItemString(capsules, name);
    const char *signature = capsule ? PyCapsule_GetName(capsule) : NULL;
    if (!signature || strncmp(signature, begins, strlen(begins)) != 0) {
        PyErr_Format(PyExc_ImportError, "SciPy offers no %s with the arguments that mbkf passes", name);
        return NULL;
    }
    return PyCapsule_GetPointer(capsule, signature);
}

/* connect(capsules): takes BLAS and LAPACK routines from SciPy's, by name */
static PyObject *py_connect(PyObject *self, PyObject *capsules)
{
    (void)self;
    if (!PyDict_Check(capsules)) {
        PyErr_SetString(PyExc_TypeError, "connect takes a dictionary of capsules");
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

static PyMethodDef connecting[] = {{"connect", py_connect, METH_O, NULL}, {NULL, NULL, 0, NULL}};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "mbkf.kernel._kernel", "Compiled arithmetic of a filter's step.", -1, declared_functions,
    NULL,                  NULL,                  NULL,                                      NULL,
};

PyMODINIT_FUNC PyInit__kernel(void)
{
    import_array();
    PyObject *module = PyModule_Create(&definition);
    if (module && (PyModule_AddFunctions(module, connecting) < 0 ||
                   PyModule_AddStringConstant(module, "fingerprint", fingerprint) < 0))
        Py_CLEAR(module);
    return module;
}
