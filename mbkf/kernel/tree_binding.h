/* Python's functions of a tree; see tree_binding.c. */
#ifndef MBKF_TREE_BINDING_H
#define MBKF_TREE_BINDING_H

#include "arrays.h"

extern PyMethodDef tree_functions[];

#endif
