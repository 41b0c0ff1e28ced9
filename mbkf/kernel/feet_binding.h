/* Python's functions of feet; see feet_binding.c. */
#ifndef MBKF_FEET_BINDING_H
#define MBKF_FEET_BINDING_H

#include "arrays.h"

extern PyMethodDef feet_functions[];

#endif
