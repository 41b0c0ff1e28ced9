/* Markers on a tree, as mbkf/sensors/marker_sensor.py reads them with their Jacobian H. Their information, the sum of
 * H'H / sd^2, is the mass matrix of the tree with point masses 1/sd^2 at the markers, which the composite rigid body
 * algorithm finds without any H (Featherstone, Rigid Body Dynamics Algorithms, 2008, ch. 6). */
#include <math.h>
#include <string.h>

#include "tree.h"

void mbkf_marker_places(int M, Tree *tree, const int *joint_ids, const double *local, const double *q, double *places,
                        double *jacobian)
{
    tree_place(tree, q);
    for (int m = 0; m < M; m++) {
        const double *frame = tree->frames + 12 * joint_ids[m];
        rotated(frame, local + 3 * m, places + 3 * m);
        for (int i = 0; i < 3; i++)
            places[3 * m + i] += frame[9 + i];
    }
    memcpy(jacobian, tree->axes, sizeof *tree->axes * tree->nv);
}

int mbkf_marker_innovations(int M, const double *measured, const double *places, double radius, double *innovation,
                            double *squared, char *seen)
{
    int near = 1;
    for (int m = 0; m < M; m++) {
        double *y = innovation + 3 * m;
        for (int i = 0; i < 3; i++)
            y[i] = measured[3 * m + i] - places[3 * m + i];
        const double length = dot3(y, y);
        seen[m] = !isnan(length);
        squared[m] = seen[m] ? length : 0.0;
        near = near && squared[m] <= radius * radius;
    }
    return near;
}

/* plausible (mbkf/stream/source.py). */
int mbkf_plausible_points(int n, const double *points, double farthest, int *absent, double *shown)
{
    int wrong = 0;
    *absent = 0;
    for (int i = 0; i < n; i++) {
        const double *p = points + 3 * i;
        const int near = fabs(p[0]) <= farthest && fabs(p[1]) <= farthest && fabs(p[2]) <= farthest;
        wrong += !near && !isnan(p[0]) && !isnan(p[1]) && !isnan(p[2]);
        *absent += !near;
        for (int c = 0; c < 3; c++)
            shown[3 * i + c] = near ? p[c] : NAN;
    }
    return wrong;
}

/* Adds a reading as a point mass at p with force weight y; p is taken from the markers' middle. */
static void accumulate_reading(Composite *on, double weight, const double *p, const double *y)
{
    double force[3], moment[3];
    Inertia *all = &on->inertia;
    all->mass += weight;
    for (int i = 0; i < 3; i++) {
        all->first[i] += weight * p[i];
        force[i] = weight * y[i];
    }
    all->second[0] += weight * (p[1] * p[1] + p[2] * p[2]);
    all->second[1] -= weight * p[0] * p[1];
    all->second[2] -= weight * p[0] * p[2];
    all->second[3] += weight * (p[0] * p[0] + p[2] * p[2]);
    all->second[4] -= weight * p[1] * p[2];
    all->second[5] += weight * (p[0] * p[0] + p[1] * p[1]);
    cross(p, force, moment);
    for (int i = 0; i < 3; i++) {
        on->force[i] += force[i];
        on->force[3 + i] += moment[i];
    }
}

/* Entries of a joint's dofs with those of its own and of the joints that carry it. */
static void project(const Tree *tree, int i, const double (*motion)[6], double *matrix, double *vector)
{
    const Joint *joint = &tree->joint[i];
    const Composite *on = &tree->composite[i];
    for (int d = joint->at_v; d < joint->at_v + joint->dofs; d++) {
        double moved[6];
        momentum(&on->inertia, motion[d], moved);
        vector[d] = dot6(motion[d], on->force);
        for (int k = i; k; k = tree->joint[k].parent) {
            const Joint *bearer = &tree->joint[k];
            for (int e = bearer->at_v; e < bearer->at_v + bearer->dofs; e++)
                matrix[e * tree->nv + d] = matrix[d * tree->nv + e] = dot6(motion[e], moved);
        }
    }
}

double mbkf_marker_information(int M, Tree *tree, const int *joint_ids, const double *weights, const char *trusted,
                               const double *jacobian, const double *places, const double *innovation, double *matrix,
                               double *vector)
{
    double centre[3] = {0.0, 0.0, 0.0}, squared = 0.0;
    double(*motion)[6] = tree->motion;
    int used = 0;
    memset(matrix, 0, sizeof *matrix * tree->nv * tree->nv);
    memset(vector, 0, sizeof *vector * tree->nv);
    memset(tree->composite, 0, sizeof *tree->composite * tree->joints);
    /* Moments are about the markers' middle: about the world's origin, far away, they would lose digits. */
    for (int m = 0; m < M; m++)
        if (trusted[m]) {
            used++;
            for (int i = 0; i < 3; i++)
                centre[i] += places[3 * m + i];
        }
    for (int i = 0; i < 3; i++)
        centre[i] /= used ? used : 1;
    for (int m = 0; m < M; m++)
        if (trusted[m]) {
            const double *y = innovation + 3 * m;
            double p[3];
            for (int i = 0; i < 3; i++)
                p[i] = places[3 * m + i] - centre[i];
            accumulate_reading(&tree->composite[joint_ids[m]], weights[m], p, y);
            squared += weights[m] * dot3(y, y);
        }
    for (int d = 0; d < tree->nv; d++) {
        const double *axis = jacobian + 6 * d;
        double along[3];
        cross(axis + 3, centre, along);
        for (int i = 0; i < 3; i++) {
            motion[d][i] = axis[i] + along[i];
            motion[d][3 + i] = axis[3 + i];
        }
    }
    for (int i = tree->joints - 1; i; i--) {
        project(tree, i, (const double(*)[6])motion, matrix, vector);
        if (tree->joint[i].parent)
            accumulate(&tree->composite[tree->joint[i].parent], &tree->composite[i]);
    }
    return squared;
}
