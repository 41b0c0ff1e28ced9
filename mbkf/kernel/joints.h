/* Joints of a state: first dof and end of each (J x 2), within which derivatives of the configuration couple dofs. */
#ifndef MBKF_JOINTS_H
#define MBKF_JOINTS_H

#include "call.h"

/* True if joints, one after the other, have all of nv dofs; the call is refused if not. */
static inline int are_all_dofs(int J, const int *joints, int nv)
{
    int end = 0;
    for (int k = 0; k < J && end >= 0; k++)
        end = joints[2 * k] == end && joints[2 * k + 1] > end ? joints[2 * k + 1] : -1;
    if (end != nv)
        refuse("joints must have all dofs, one joint after the other");
    return end == nv;
}

#endif
