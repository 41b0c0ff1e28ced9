/* Transition of an error from one frame to the next by its parts; see transition.c. */
#ifndef MBKF_TRANSITION_H
#define MBKF_TRANSITION_H

/* Phi of mbkf/numerics/transition.py: A, B (nv x nv), joints (J x 2), push (orders), rates (orders x orders). */
typedef struct {
    int nv, orders, J;
    const double *A, *B, *push, *rates;
    const int *joints;
} Transition;

/* out = Phi' L, row by row. */
void rows_before(int N, const double *L, const Transition *phi, double *out);

/* out = Phi X, row by row. */
void rows_after(int N, const double *X, const Transition *phi, double *out);

/* before = Phi' gradient */
void vector_before(int N, const Transition *phi, const double *gradient, double *before);

/* y += Phi x */
void add_moved(int N, const Transition *phi, const double *x, double *y);

/* back = Phi^-1, which is a transition, too; work holds inverse_size numbers. Returns 1 if there is no inverse. */
int inverse(const Transition *phi, Transition *back, double *work);
long inverse_size(int nv, int orders);

#endif
