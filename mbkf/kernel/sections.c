/* Loads at a section of the trunk with their derivatives (mbkf/model/trunk_sections.py), of a tree whose segments are
 * those above the section. By way: from the upper part's motion, and that less the residual of the whole body. */
#include <string.h>

#include "call.h"
#include "dynamics.h"
#include "rotation.h"

enum { ROOT = 6, WAYS = 2 };

/* total (n) += x y */
static void plus(long n, double x, const double *y, double *total)
{
    for (long i = 0; i < n; i++)
        total[i] += x * y[i];
}

/* Adds m x e_j to the columns j of moments m by the dofs of the joint above, whose axes turn with it. Rows and columns are
 * so many numbers apart. */
static void turn(const double *moment, long down, long right, double *rows)
{
    double across[9];
    cross_matrix(moment, across);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            rows[i * down + j * right] += across[3 * i + j];
}

/* by_root (3 x 6): moment about the section in the axes of the joint above, by a wrench in the root's axes. */
static void set_by_root(const Tree *tree, const double *transport, int above, double *by_root)
{
    double R[9];
    for (int i = 0; i < 9; i += 3)
        rotated_back(tree->frames + 12, tree->frames + 12 * above + i, R + i);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < ROOT; j++)
            by_root[ROOT * i + j] = R[3 * i] * transport[j] + R[3 * i + 1] * transport[ROOT + j] +
                                    R[3 * i + 2] * transport[2 * ROOT + j];
}

void mbkf_section_state(int N, Tree *tree, const double *q, const double *v, const double *a, const double *carried,
                        const double *transport, int above, const double *residual, const double *by_state,
                        double *wrench, double *moment, double *rows, double *by_root)
{
    const long known = 3L * tree->nv, stride = known + 2 * ROOT;
    const Joint *joint = &tree->joint[above];
    double *slopes = workspace(ROOT * stride);
    if (!slopes)
        return;
    mbkf_root_dynamics(tree, q, v, a, carried, wrench, slopes);
    set_by_root(tree, transport, above, by_root);
    memset(rows, 0, sizeof *rows * WAYS * 3 * N);
    for (int j = 0; j < ROOT; j++)
        wrench[ROOT + j] = wrench[j] - residual[j];
    for (int i = 0; i < 3; i++) {
        const double *own = by_root + ROOT * i;
        double *down = rows + (long)i * N, *up = rows + (long)(3 + i) * N;
        for (int way = 0; way < WAYS; way++)
            moment[3 * way + i] = dot6(own, wrench + ROOT * way);
        for (int j = 0; j < ROOT; j++)
            plus(known, own[j], slopes + j * stride, down);
        memcpy(up, down, sizeof *rows * N);
        for (int j = 0; j < ROOT; j++)
            plus(N, -own[j], by_state + (long)j * N, up);
    }
    for (int way = 0; way < WAYS && joint->kind == SPHERICAL; way++)
        turn(moment + 3 * way, N, 1, rows + 3L * way * N + joint->at_v);
}

/* True if a joint hangs on another one, or is it. */
static int hangs_on(const Tree *tree, int joint, int on)
{
    while (joint > on)
        joint = tree->joint[joint].parent;
    return joint == on;
}

/* Three rows of a column: moments about axes by a force and by one that is added to it. */
static void put(const double axes[3][ROOT], const double *force, const double *further, double *rows)
{
    double total[ROOT];
    for (int c = 0; c < ROOT; c++)
        total[c] = force[c] + (further ? further[c] : 0.0);
    for (int i = 0; i < 3; i++)
        rows[i] = dot6(axes[i], total);
}

/* Derivatives (3 x 3 nv, columns m apart) of the moment about a section by the motion of the part above, and that moment:
 * a wrench's work on axes, which are the moments' own about the section. */
static void differentiate_above(const Tree *tree, const Joint *part, int above, const double *by_root, long m,
                                double *moment, double *rows)
{
    const long block = tree->nv * m;
    double axes[3][ROOT];
    Composite upper;
    Derivative by[ROOT];
    tree_upper(tree, part, above, &upper, by);
    memset(axes, 0, sizeof axes);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < ROOT; j++)
            plus(ROOT, by_root[ROOT * i + j], tree->axes[j], axes[i]);
    put(axes, upper.force, NULL, moment);
    for (int n = 1; n < tree->joints; n++) {
        const Joint *joint = &tree->joint[n];
        if (n > 1 && !hangs_on(tree, n, above))
            continue;
        for (int k = joint->at_v; k < joint->at_v + joint->dofs; k++) {
            const Derivative *one = n == 1 ? by + (k - joint->at_v) : tree->by + k;
            double *column = rows + k * m;
            put(axes, one->force_by_q, n == 1 ? NULL : one->turned_force, column); /* the root turns the axes, too */
            put(axes, one->force_by_v, NULL, column + block);
            put(axes, one->force_by_a, NULL, column + 2 * block);
        }
    }
}

/* A part of the root's segment from its row: mass, centre of mass, inertia about it. */
static Joint part_of(const double *row)
{
    Joint part = {.mass = row[0]};
    memcpy(part.lever, row + 1, sizeof part.lever);
    memcpy(part.inertia, row + 4, sizeof part.inertia);
    return part;
}

void mbkf_upper_forces(int frames, int L, Tree *tree, const double *q, const double *v, const double *a,
                       const int *above, const double *parts, double *upper)
{
    for (int t = 0; t < frames; t++, q += tree->nq, v += tree->nv, a += tree->nv) {
        tree_forces(tree, q, v, a);
        for (int k = 0; k < L; k++, upper += ROOT) {
            const Joint part = part_of(parts + 13 * k);
            Composite one;
            tree_part(tree, &part, &one);
            plus(ROOT, 1.0, tree->composite[above[k]].force, one.force);
            for (int i = 0; i < ROOT; i++)
                upper[i] = dot6(tree->axes[i], one.force);
        }
    }
}

void mbkf_load_derivatives(int L, Tree *tree, const double *q, const double *v, const double *a, const char *moves,
                           const double *wrenches, const int *above, const double *transports, const double *parts,
                           double *tau, double *by_state)
{
    const long m = 6L * L + tree->nv, N = 3L * tree->nv + 12;
    double *torques = by_state + 6L * L, *by_root = workspace(3L * L * ROOT);
    if (!by_root)
        return;
    memset(by_state, 0, sizeof *by_state * m * N);
    tree_torques(tree, q, v, a, moves, wrenches, m, tau, torques);
    for (int k = 0; k < L; k++) {
        const Joint part = part_of(parts + 13 * k);
        double moment[WAYS][3], *own = by_root + 3 * ROOT * k, *down = by_state + 3 * k, *up = down + 3L * L;
        const Joint *joint = &tree->joint[above[k]];
        set_by_root(tree, transports + 3 * ROOT * k, above[k], own);
        differentiate_above(tree, &part, above[k], own, m, moment[0], down);
        for (int i = 0; i < 3; i++) {
            moment[1][i] = moment[0][i] - dot6(own + ROOT * i, tau);
            for (long c = 0; c < N; c++)
                up[c * m + i] = down[c * m + i] - dot6(own + ROOT * i, torques + c * m);
        }
        for (int way = 0; way < WAYS && joint->kind == SPHERICAL; way++)
            turn(moment[way], 1, m, (way ? up : down) + joint->at_v * m);
    }
}
