/* Python's functions of a tree; see tree_binding.c. */
#ifndef MBKF_TREE_BINDING_H
#define MBKF_TREE_BINDING_H

#include "arrays.h"
#include "tree.h"

extern PyMethodDef tree_functions[];

/* The tree of a capsule; NULL with an error set. */
Tree *tree_in(PyObject *capsule);

/* A function that takes its arguments as an array. */
#define QUICK(function) (PyCFunction)(void (*)(void)) function, METH_FASTCALL

#endif
