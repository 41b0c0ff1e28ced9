/* A body as a tree of joints, and where a configuration puts it; see tree.c.
 *
 * Joint 0 is the world; parents come before their children. Joints are those of Pinocchio that HumanModel makes: free
 * (position, unit quaternion x y z w; velocity in own axes), spherical (quaternion) and hinges. */
#ifndef MBKF_TREE_H
#define MBKF_TREE_H

#include "spatial.h"

enum { FREE = 0, SPHERICAL = 1, HINGE = 2 };

/* What does not change. Matrices stand column by column. */
typedef struct {
    int parent, kind, at_q, at_v, dofs;
    double axis[3];           /* of a hinge, of unit length */
    double turn[9], shift[3]; /* its place in its parent's frame */
    double mass, lever[3];    /* of its segment, in its own frame */
    double inertia[9];        /* about the segment's centre of mass */
} Joint;

/* Of a joint's segment, and after tree_differentiated of all that the joint carries. */
typedef struct {
    double velocity[6], acceleration[6]; /* the latter less gravity's */
    Inertia inertia;
    double force[6];    /* inertia x acceleration + velocity x* momentum */
    double impulse[3];  /* linear momentum */
    double gyration[9]; /* see dynamics.c */
    double load[6];     /* wrenches from outside */
} Carried;

/* Of a dof. Motions are those of what it moves, as seen from there; forces are of all that it moves. */
typedef struct {
    double drag[6], by_q[6], by_v[6]; /* velocity by q, acceleration by q and by v */
    double force_by_q[6], force_by_v[6], force_by_a[6];
    double swung[6]; /* how the force itself turns with the dof */
} Derivative;

/* With memory to work in: one call at a time. */
typedef struct {
    int joints, nq, nv;
    double gravity[6];
    Joint *joint;      /* (joints) */
    double *frames;    /* (joints x 12) x, y, z axes and origin in the world */
    double (*axes)[6]; /* (nv) velocity of what a dof moves: the Jacobian's columns */
    double (*motion)[6]; /* (nv) the same, seen from elsewhere than the world's origin */
    Carried *carried;  /* (joints) */
    Derivative *by;    /* (nv) */
} Tree;

/* NULL where there is no memory. Its joints are to be filled in. */
Tree *tree_made(int joints, int nq, int nv);
void tree_freed(Tree *tree);

/* Frames and axes at a configuration. */
void tree_placed(Tree *tree, const double *q);

/* Derivative (nv) of the height of a joint's origin by the configuration that the tree was placed at. */
void tree_rise(const Tree *tree, int joint, double *rise);

#endif
