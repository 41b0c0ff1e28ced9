/* A body as a tree of joints, and its places at a configuration; see tree.c.
 *
 * Joint 0 is the world; parents come before their children. Joints are those of Pinocchio that HumanModel makes: free
 * (position, unit quaternion x y z w; velocity in own axes), spherical (quaternion) and hinges. */
#ifndef MBKF_TREE_H
#define MBKF_TREE_H

#include "declared.h"
#include "spatial.h"

enum { FREE = 0, SPHERICAL = 1, HINGE = 2 };

/* Constants of a joint and of its segment. Matrices stand column by column. */
typedef struct {
    int parent, kind, at_q, at_v, dofs;
    double axis[3];                 /* of a hinge, of unit length */
    double rotation[9], origin[3];  /* in the parent's frame */
    double mass, lever[3];          /* of the segment, in its own frame */
    double inertia[9];              /* about the segment's centre of mass */
} Joint;

/* A joint's segment; after the pass from the leaves to the root, the sum of all segments that the joint carries. */
typedef struct {
    double velocity[6], acceleration[6]; /* the latter less gravity's */
    Inertia inertia;
    double force[6];    /* inertia x acceleration + velocity x* momentum */
    double impulse[3];  /* linear momentum */
    double gyration[9]; /* see dynamics.c */
} Composite;

/* Derivatives by a dof: motions of the segment that it moves, forces of all segments that it moves. */
typedef struct {
    double drag[6], by_q[6], by_v[6]; /* velocity by q, acceleration by q and by v */
    double force_by_q[6], force_by_v[6], force_by_a[6];
    double turned_force[6]; /* change of the force as it turns with the dof */
} Derivative;

/* With working memory, which makes calls take turns. */
struct Tree {
    int joints, nq, nv;
    double gravity[6];
    Joint *joint;         /* (joints) */
    double *frames;       /* (joints x 12) x, y, z axes and origin in the world */
    double (*axes)[6];    /* (nv) columns of the spatial Jacobian */
    double (*motion)[6];  /* (nv) the same about another point than the world's origin */
    Composite *composite; /* (joints) */
    Derivative *by;       /* (nv) */
};

/* Adds a composite to that of the parent. */
static inline void accumulate(Composite *to, const Composite *from)
{
    to->inertia.mass += from->inertia.mass;
    for (int i = 0; i < 3; i++) {
        to->inertia.first[i] += from->inertia.first[i];
        to->impulse[i] += from->impulse[i];
    }
    for (int i = 0; i < 6; i++) {
        to->inertia.second[i] += from->inertia.second[i];
        to->force[i] += from->force[i];
    }
    for (int i = 0; i < 9; i++)
        to->gyration[i] += from->gyration[i];
}

/* Frames and axes at a configuration. */
void tree_place(Tree *tree, const double *q);

#endif
