/* Python's functions of a tree; see tree_binding.c. */
#ifndef MBKF_TREE_BINDING_H
#define MBKF_TREE_BINDING_H

#include "arrays.h"
#include "tree.h"

extern PyMethodDef tree_functions[];

/* The tree of a capsule; NULL with an error set. */
Tree *tree_in(PyObject *capsule);

#endif
