/* Python's function of orientations; see orientation_binding.c. */
#ifndef MBKF_ORIENTATION_BINDING_H
#define MBKF_ORIENTATION_BINDING_H

#include "arrays.h"

extern PyMethodDef orientation_functions[];

#endif
