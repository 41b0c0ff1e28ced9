/* Geometry of feet and plates: mbkf/sensors/contact/feet.py, soles.py and PlateAreas.over of plates.py. */
#include "feet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "call.h"
#include "floor_motion.h"

Feet *mbkf_make_feet(int plates, Tree *tree, const int *point_joints, const int *foot_joints, int root_joint,
                     const double *points, int window, int still, int fall, double floor_m, double dt_s,
                     const ContactLimits *limits, const char *plate_known, const double *plate_least_n,
                     const double *plate_surface_m, const double *plate_box, const double *plate_edges)
{
    Feet *feet = calloc(1, sizeof *feet);
    Plate *plate = calloc(plates + 1, sizeof *plate);
    if (!feet || !plate) {
        refuse(out_of_memory);
        free(feet);
        free(plate);
        return NULL;
    }
    for (int k = 0; k < plates; k++) {
        plate[k].known = plate_known[k], plate[k].least_n = plate_least_n[k], plate[k].surface_m = plate_surface_m[k];
        memcpy(plate[k].box, plate_box + 4 * k, sizeof plate[k].box);
        memcpy(plate[k].edges, plate_edges + 16 * k, sizeof plate[k].edges);
    }
    *feet = (Feet){.tree = tree, .nq = tree->nq, .nv = tree->nv, .plates = plates, .root = root_joint,
                   .window = window, .still = still, .fall = fall, .floor_m = floor_m, .dt_s = dt_s,
                   .limits = *limits, .plate = plate};
    feet->memory = memory_length(feet);
    memcpy(feet->joint, point_joints, sizeof feet->joint);
    memcpy(feet->foot, foot_joints, sizeof feet->foot);
    memcpy(feet->point, points, sizeof feet->point);
    return feet;
}

void mbkf_free_feet(Feet *feet)
{
    free(feet->plate);
    free(feet);
}

/* FeetOnBody.at */
void feet_at(const Feet *feet, const double *q, const double *v, Motion *motion)
{
    const Tree *tree = feet->tree;
    tree_place(feet->tree, q);
    for (int k = 0; k < FEET * SOLE; k++) {
        const double *frame = tree->frames + 12 * feet->joint[k];
        double *point = motion->sole[k / SOLE][k % SOLE];
        rotated(frame, feet->point[k], point);
        for (int i = 0; i < 3; i++)
            point[i] += frame[9 + i];
    }
    memcpy(motion->pelvis, tree->frames + 12 * feet->root + 9, sizeof motion->pelvis);
    for (int f = 0; f < FEET; f++) {
        double *twist = motion->twist[f];
        memset(twist, 0, sizeof motion->twist[f]);
        for (int j = feet->foot[f]; j > 0; j = tree->joint[j].parent)
            for (int d = tree->joint[j].at_v; d < tree->joint[j].at_v + tree->joint[j].dofs; d++)
                for (int i = 0; i < 6; i++)
                    twist[i] += v[d] * tree->axes[d][i];
        motion->down[f] = tree->frames[12 * feet->foot[f] + 8] > feet->limits.faces_down;
    }
}

int lowest_of(double (*sole)[3], int points)
{
    int lowest = 0;
    for (int k = 1; k < points; k++)
        if (sole[k][2] < sole[lowest][2])
            lowest = k;
    return lowest;
}

/* FeetMotion.velocity */
void velocity_of(const Motion *motion, int foot, const double *point, double *velocity)
{
    const double *twist = motion->twist[foot];
    cross(twist + 3, point, velocity);
    for (int i = 0; i < 3; i++)
        velocity[i] += twist[i];
}

/* FeetMotion.speed */
double speed_of(const Motion *motion, int foot, const double *point, const double *floor_m_s)
{
    double velocity[3];
    velocity_of(motion, foot, point, velocity);
    return hypot(hypot(velocity[0] - floor_m_s[0], velocity[1] - floor_m_s[1]), velocity[2]);
}

/* PlateAreas.over */
int over_plate(const Plate *plate, double x, double y)
{
    const double *box = plate->box;
    int left = 0;
    if (!(plate->known && box[0] <= x && x <= box[2] && box[1] <= y && y <= box[3]))
        return 0;
    for (int i = 0; i < 4; i++) {
        const double *edge = plate->edges[i];
        left += edge[2] * (y - edge[1]) - edge[3] * (x - edge[0]) >= 0.0;
    }
    return left == 0 || left == 4;
}

/* soles.distance_to_sole */
double distance_to_sole(double x, double y, double (*sole)[3])
{
    const double ax = sole[2][0] - sole[0][0], ay = sole[2][1] - sole[0][1], length = ax * ax + ay * ay;
    const double share = length != 0.0 ? ((x - sole[0][0]) * ax + (y - sole[0][1]) * ay) / length : NAN;
    const double along = lesser(greater(share, 0.0), 1.0);
    return hypot(x - sole[0][0] - along * ax, y - sole[0][1] - along * ay);
}
