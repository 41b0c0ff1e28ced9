/* Transition of an error from one frame to the next by its parts. */
#ifndef MBKF_TRANSITION_H
#define MBKF_TRANSITION_H

/* Phi of mbkf/numerics/transition.py: A, B (nv x nv), joints (J x 2), push (orders), rates (orders x orders). */
typedef struct {
    int nv, orders, J;
    const double *A, *B, *push, *rates;
    const int *joints;
} Transition;

#endif
