/* Python's functions of markers on a tree; see markers_binding.c. */
#ifndef MBKF_MARKERS_BINDING_H
#define MBKF_MARKERS_BINDING_H

#include "arrays.h"

extern PyMethodDef marker_functions[];

#endif
