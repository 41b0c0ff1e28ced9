/* Mass matrix of a tree by the composite rigid body algorithm (Featherstone, Rigid Body Dynamics Algorithms, 2008, ch. 6),
 * and its inverse on the dofs that forces move: forward dynamics and its derivatives are products with it. */
#include <string.h>

#include "call.h"
#include "dynamics.h"
#include "factor.h"
#include "product.h"
#include "symmetric.h"

/* The dofs' axes about a point: about the world's origin, far away, moments of inertia would lose digits. */
static void move_axes(const Tree *tree, const double *point, double (*axes)[6])
{
    for (int d = 0; d < tree->nv; d++) {
        double along[3];
        cross(tree->axes[d] + 3, point, along);
        for (int i = 0; i < 3; i++) {
            axes[d][i] = tree->axes[d][i] + along[i];
            axes[d][3 + i] = tree->axes[d][3 + i];
        }
    }
}

/* Inertia of every segment by itself, about a point. */
static void set_inertias(Tree *tree, const double *point)
{
    memset(tree->composite, 0, sizeof *tree->composite * tree->joints);
    for (int i = 1; i < tree->joints; i++) {
        double frame[12];
        if (tree->joint[i].mass == 0.0)
            continue;
        memcpy(frame, tree->frames + 12 * i, sizeof frame);
        for (int k = 0; k < 3; k++)
            frame[9 + k] -= point[k];
        segment_inertia(&tree->joint[i], frame, &tree->composite[i].inertia);
    }
}

static void set_mass(Tree *tree, const double *q, double *mass)
{
    const long nv = tree->nv;
    tree_place(tree, q);
    const double *root = tree->frames + 12 + 9;
    move_axes(tree, root, tree->motion);
    set_inertias(tree, root);
    memset(mass, 0, sizeof *mass * nv * nv);
    for (int i = tree->joints - 1; i; i--) {
        const Joint *joint = &tree->joint[i];
        const Composite *one = &tree->composite[i];
        for (int d = joint->at_v; d < joint->at_v + joint->dofs; d++) {
            double moved[6];
            momentum(&one->inertia, tree->motion[d], moved);
            for (int k = i; k; k = tree->joint[k].parent) {
                const Joint *bearer = &tree->joint[k];
                for (int e = bearer->at_v; e < bearer->at_v + bearer->dofs; e++)
                    mass[e * nv + d] = mass[d * nv + e] = dot6(tree->motion[e], moved);
            }
        }
        if (joint->parent)
            accumulate(&tree->composite[joint->parent], one);
    }
}

int mbkf_mass_inverse(Tree *tree, const double *q, const char *moving, double *mass, double *inverse)
{
    const long nv = tree->nv;
    int n = 0;
    double *L = workspace(3 * nv * nv);
    if (!L)
        return 0;
    double *X = L + nv * nv, *found = X + nv * nv;
    set_mass(tree, q, mass);
    memset(inverse, 0, sizeof *inverse * nv * nv);
    for (int d = 0; d < nv; d++)
        n += moving[d] != 0;
    for (int d = 0, j = 0; d < nv; d++) {
        if (!moving[d])
            continue;
        for (int e = 0, i = 0; e < nv; e++)
            if (moving[e])
                L[(long)j * n + i++] = mass[d * nv + e];
        j++;
    }
    if (factored(n, L))
        return 1;
    memset(X, 0, sizeof *X * n * n);
    for (int i = 0; i < n; i++)
        X[(long)i * (n + 1)] = 1.0;
    divided(n, n, L, X);
    product(LOWER, n, n, n, 1.0, X, n, X, n, 0.0, NULL, found, n);
    mirror(n, found);
    for (int d = 0, j = 0; d < nv; d++) {
        if (!moving[d])
            continue;
        for (int e = 0, i = 0; e < nv; e++)
            if (moving[e])
                inverse[d * nv + e] = found[(long)j * n + i++];
        j++;
    }
    return 0;
}
