/* Both feet at one state, and the plates that they may stand on; see feet.c. */
#ifndef MBKF_FEET_H
#define MBKF_FEET_H

#include "tree.h"

enum { RIGHT = 0, LEFT = 1, FEET = 2, SOLE = 3, SOLE_ENDS = 2 };

/* A plate's outline from above as a box (least x and y, greatest x and y) and edges (x, y, along x, along y). */
typedef struct {
    int known;
    double least_n, surface_m, box[4], edges[4][4];
} Plate;

/* Constants. Points are heel, ball and toe end of the right and of the left sole. */
struct Feet {
    Tree *tree;
    int nq, nv, plates, memory; /* memory: numbers that a frame keeps for the next, see floor_motion.h */
    int joint[FEET * SOLE], foot[FEET], root;
    int window, still, fall; /* frames of the floor's velocity, of a floor that stands still, and of a fall */
    double point[FEET * SOLE][3];
    double floor_m, dt_s;
    ContactLimits limits;
    Plate *plate;
};

/* The feet at a state: soles, pelvis, velocity of each foot at the world's origin, and feet whose soles face down. */
typedef struct {
    double sole[FEET][SOLE][3], pelvis[3], twist[FEET][6];
    int down[FEET];
} Motion;

void feet_at(const Feet *feet, const double *q, const double *v, Motion *motion);

/* Index of the lowest of a sole's first so many points. */
int lowest_of(double (*sole)[3], int points);

void velocity_of(const Motion *motion, int foot, const double *point, double *velocity);

/* Against a floor that moves horizontally. */
double speed_of(const Motion *motion, int foot, const double *point, const double *floor_m_s);

int over_plate(const Plate *plate, double x, double y);

double distance_to_sole(double x, double y, double (*sole)[3]);

/* The lesser and the greater of two numbers as Python takes them: the first if one is NaN. */
static inline double lesser(double a, double b) { return b < a ? b : a; }
static inline double greater(double a, double b) { return b > a ? b : a; }

#endif
