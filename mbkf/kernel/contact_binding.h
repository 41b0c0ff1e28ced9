/* Python's functions of the feet; see contact_binding.c. */
#ifndef MBKF_CONTACT_BINDING_H
#define MBKF_CONTACT_BINDING_H

#include "arrays.h"

extern PyMethodDef contact_functions[];

#endif
