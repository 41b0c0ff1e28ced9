/* A frame of markers through the kinematic filter in one go, while every segment with markers shows one near its
 * prediction: mbkf/filters/kinematic/one_call.py. */
#include <stdlib.h>
#include <string.h>

#include "call.h"
#include "tree.h"

/* True where enough markers are seen, and one of every joint that carries any. */
static int shows_all(int M, const int *joint_ids, const char *seen, int least)
{
    int count = 0;
    for (int m = 0; m < M; m++) {
        int shown = seen[m];
        count += seen[m];
        for (int k = 0; k < M && !shown; k++)
            shown = seen[k] && joint_ids[k] == joint_ids[m];
        if (!shown)
            return 0;
    }
    return count >= least;
}

int mbkf_follow_markers(int J, int M, Tree *tree, const int *joints, double dt, const double *noise,
                        const int *joint_ids, const double *local, const double *weights, double radius, int least,
                        const double *start, const double *postures, const double *P, const double *q,
                        const double *v, const double *measured, double *P_before, double *q_before, double *innovation,
                        double *squared, char *seen, double *by_markers, double *towards_markers, double *matrix,
                        double *vector, double *P_after, double *q_after, double *v_after, double *size)
{
    const int nv = tree->nv, N = 2 * nv;
    const long square = (long)nv * nv;
    double *A = malloc(sizeof *A * (2 * square + 10L * nv + 3L * M));
    if (!A) {
        refuse(out_of_memory);
        return 0;
    }
    double *B = A + square, *step = B + square, *angles = step + N, *jacobian = angles + N, *places = jacobian + 6L * nv;
    int follows = 0;
    *size = 0.0;
    for (int i = 0; i < nv; i++)
        step[i] = dt * v[i];
    mbkf_integration_derivatives(tree, step, A, B);
    mbkf_propagate_velocities(nv, J, P, A, B, joints, dt, noise, P_before);
    mbkf_integrate(tree, q, step, q_before);
    mbkf_marker_places(M, tree, joint_ids, local, q_before, places, jacobian);
    if (mbkf_marker_innovations(M, measured, places, radius, innovation, squared, seen) &&
        shows_all(M, joint_ids, seen, least)) {
        *size = mbkf_marker_information(M, tree, joint_ids, weights, seen, jacobian, places, innovation, by_markers,
                                        towards_markers);
        mbkf_deviation(tree, start, q_before, angles, A);
        mbkf_posture_information(tree, angles, A, postures, matrix, vector);
        for (long i = 0; i < square; i++)
            matrix[i] += by_markers[i];
        for (int i = 0; i < nv; i++)
            vector[i] += towards_markers[i];
        follows = mbkf_add_information(N, nv, 0, P_before, matrix, NULL, P_after) == 0;
    }
    if (follows) {
        mbkf_correction(N, nv, 0, P_after, vector, NULL, NULL, step);
        mbkf_integrate(tree, q_before, step, q_after);
        for (int i = 0; i < nv; i++)
            v_after[i] = v[i] + step[nv + i];
    }
    free(A);
    return follows;
}
