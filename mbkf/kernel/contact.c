/* Contact of both feet in one frame, by the rules of mbkf/sensors/contact/rules.py in the order of causal.py
 * (ContactDetector.decide) and unmeasured.py (UnmeasuredFeet.decide). Functions name those that they repeat. */
#include <math.h>
#include <string.h>

#include "call.h"
#include "floor_motion.h"

enum { UNMEASURED = -1, AIR = 0, MEASURED = 1, SHARED = 2 };
enum { BOTH = 2, NONE = -1 };

/* Flags beside the kinds of contact (those of right and left foot, plus one, in two bits each). */
enum { STRAY = 16, ON_ONE_PLATE = 32, ON_OPEN_FLOOR = 64, MOVING_OR_NEAR = 128, BELOW = 256 };

/* State and readings of a frame; wrench (plates x 6) is NaN where not recorded. */
typedef struct {
    const double *q, *v, *a, *wrench;
    int supported;
} Seen;

/* The frame as far as it is decided. */
typedef struct {
    const Feet *feet;
    const double *before; /* memory from the frame before */
    Motion motion;
    int kind[FEET];
    int unloaded, silent;         /* how many plates */
    double floor_m, floor_m_s[2]; /* height, NaN where not known, and horizontal velocity */
    int may_bear[FEET], carries[FEET];
} Scene;

static const double *plate_before(const Scene *scene, int k) { return scene->before + HEAD + PER_PLATE * k; }

/* rules.stand_together, of feet over the same plate */
static int both_on(Scene *scene, const Plate *plate, double slack)
{
    const ContactLimits *limits = &scene->feet->limits;
    double *point[FEET], velocity[FEET][3];
    for (int f = 0; f < FEET; f++)
        point[f] = scene->motion.sole[f][lowest_of(scene->motion.sole[f], SOLE)];
    if (!(fabs(point[RIGHT][2] - point[LEFT][2]) < limits->level_m))
        return 0;
    for (int f = 0; f < FEET; f++) {
        if (!over_plate(plate, point[f][0], point[f][1]))
            return 0;
        velocity_of(&scene->motion, f, point[f], velocity[f]);
    }
    for (int i = 0; i < 3; i++)
        velocity[0][i] -= velocity[1][i];
    return hypot(hypot(velocity[0][0], velocity[0][1]), velocity[0][2]) < slack * limits->parted_m_s;
}

/* rules.swings_over */
static int swings_over(Scene *scene, int foot)
{
    double floor_m_s[2], speed[FEET];
    movement_velocity(scene->feet, scene->before, floor_m_s);
    for (int f = 0; f < FEET; f++) {
        double (*sole)[3] = scene->motion.sole[f];
        speed[f] = speed_of(&scene->motion, f, sole[lowest_of(sole, SOLE)], floor_m_s);
    }
    return speed[foot] > speed[1 - foot] + scene->feet->limits.parted_m_s;
}

/* ContactDetector._owner and rules.nearer_foot */
static int owner_of(Scene *scene, const Plate *plate, const double *pressed, int before)
{
    const ContactLimits *limits = &scene->feet->limits;
    double away[FEET];
    if (both_on(scene, plate, before == BOTH ? limits->leave_slack : 1.0))
        return BOTH;
    for (int f = 0; f < FEET; f++)
        away[f] = distance_to_sole(pressed[0], pressed[1], scene->motion.sole[f]);
    int nearest = away[RIGHT] <= away[LEFT] ? RIGHT : LEFT;
    if ((before == RIGHT || before == LEFT) && away[before] <= away[nearest] + limits->keep_m)
        nearest = before;
    if (!(away[nearest] <= limits->reach_m))
        return NONE;
    if (nearest == 1 - before && away[before] <= limits->reach_m && swings_over(scene, nearest))
        return before;
    return nearest;
}

/* Assigns plates to feet and sums their readings, those below a load apart; returns flags of the decision. */
static int assign_plates(Scene *scene, const Seen *seen, double *after, double *foot_wrench, double *below)
{
    int flags = 0;
    memset(foot_wrench, 0, 12 * sizeof *foot_wrench);
    memset(below, 0, 6 * sizeof *below);
    memcpy(after + HEAD, scene->before + HEAD, sizeof *after * PER_PLATE * scene->feet->plates);
    for (int k = 0; k < scene->feet->plates; k++) {
        const Plate *plate = &scene->feet->plate[k];
        const double *w = seen->wrench + 6 * k;
        double *kept = after + HEAD + PER_PLATE * k;
        kept[FOOT_OF_PLATE] = NONE;
        if (!(w[2] >= plate->least_n)) {
            *(w[2] < plate->least_n ? &scene->unloaded : &scene->silent) += 1;
            if (w[2] > 0.0) {
                flags |= BELOW;
                for (int i = 0; i < 6; i++)
                    below[i] += w[i];
            }
            continue;
        }
        kept[PRESSED] = (plate->surface_m * w[0] - w[4]) / w[2];
        kept[PRESSED + 1] = (plate->surface_m * w[1] + w[3]) / w[2];
        const int owner = owner_of(scene, plate, kept + PRESSED, (int)plate_before(scene, k)[FOOT_OF_PLATE]);
        kept[FOOT_OF_PLATE] = kept[PRESSED_BY] = owner;
        flags |= owner == NONE ? STRAY : owner == BOTH ? ON_ONE_PLATE : 0;
        for (int f = 0; f < FEET; f++)
            if (owner == f || owner == BOTH) {
                scene->kind[f] = owner == BOTH ? SHARED : MEASURED;
                for (int i = 0; i < 6; i++)
                    foot_wrench[6 * f + i] += w[i];
            }
    }
    return flags;
}

static double height_of(const Scene *scene, int foot)
{
    return lesser(scene->motion.sole[foot][0][2], scene->motion.sole[foot][1][2]);
}

/* UnmeasuredFeet._sole_height */
static double sole_height(const Scene *scene)
{
    const double height[FEET] = {height_of(scene, RIGHT), height_of(scene, LEFT)};
    double known = scene->before[SOLE_HEIGHT];
    for (int f = 0; f < FEET; f++)
        if (scene->kind[f] == MEASURED)
            known = isnan(known) ? height[f] : known + scene->feet->limits.floor_share * (height[f] - known);
    if (isnan(scene->feet->floor_m)) {
        const double lowest = lesser(height[RIGHT], height[LEFT]);
        known = isnan(known) ? lowest : lesser(known, lowest);
    }
    return known;
}

/* UnmeasuredFeet._movement; the height and velocity of the floor follow from it */
static void find_floor(Scene *scene, double *after)
{
    double (*soles)[SOLE][3] = scene->motion.sole, low[3] = {NAN, NAN, NAN};
    const double height = after[SOLE_HEIGHT] = sole_height(scene);
    const double *point[FEET];
    scene->floor_m = isnan(height) ? scene->feet->floor_m : height;
    for (int f = 0; f < FEET; f++)
        point[f] = soles[f][lowest_of(soles[f], SOLE_ENDS)];
    const int foot = point[LEFT][2] < point[RIGHT][2] ? LEFT : RIGHT;
    if (point[foot][2] < scene->floor_m + scene->feet->limits.stand_height_m)
        velocity_of(&scene->motion, foot, point[foot], low);
    movement_add_frame(scene->feet, scene->before, low, scene->motion.pelvis, after);
    movement_velocity(scene->feet, after, scene->floor_m_s);
}

/* True if a plate reads less than a load. */
static int reads_nothing(const Scene *scene, const Seen *seen, int k)
{
    return seen->wrench[6 * k + 2] < scene->feet->plate[k].least_n;
}

/* UnmeasuredFeet._watched */
static int watched(Scene *scene, const Seen *seen, int foot)
{
    double (*sole)[3] = scene->motion.sole[foot];
    const double x = 0.5 * (sole[0][0] + sole[2][0]), y = 0.5 * (sole[0][1] + sole[2][1]);
    const int belt = scene->floor_m_s[0] != 0.0 || scene->floor_m_s[1] != 0.0;
    for (int k = 0; k < scene->feet->plates; k++) {
        const Plate *plate = &scene->feet->plate[k];
        const double *kept = plate_before(scene, k);
        if (!reads_nothing(scene, seen, k))
            continue;
        if (plate->known ? over_plate(plate, x, y)
                         : kept[PRESSED_BY] == foot &&
                               (belt || distance_to_sole(kept[PRESSED], kept[PRESSED + 1], sole) <=
                                            scene->feet->limits.reach_m))
            return 1;
    }
    return 0;
}

/* unmeasured._touches */
static int touches(Scene *scene, int foot, double floor_m, double height, double speed)
{
    for (int k = 0; k < SOLE_ENDS; k++) {
        const double *point = scene->motion.sole[foot][k];
        if (point[2] < floor_m + height && speed_of(&scene->motion, foot, point, scene->floor_m_s) < speed)
            return 1;
    }
    return 0;
}

/* UnmeasuredFeet._touched_s and _touching */
static double touched_for(Scene *scene, const Seen *seen, int foot)
{
    const ContactLimits *limits = &scene->feet->limits;
    double since = scene->before[TOUCHING + foot];
    if (!scene->may_bear[foot] || !scene->motion.down[foot])
        return 0.0;
    for (int k = 0; k < scene->feet->plates; k++) {
        const int owner = (int)plate_before(scene, k)[FOOT_OF_PLATE];
        if (isnan(seen->wrench[6 * k + 2]) && (owner == foot || owner == BOTH))
            since = limits->stand_after_s + scene->feet->dt_s;
    }
    const double slack = since > limits->stand_after_s ? limits->leave_slack : 1.0;
    const int down = touches(scene, foot, scene->floor_m, slack * limits->stand_height_m, slack * limits->stand_speed_m_s);
    return down ? since + scene->feet->dt_s : 0.0;
}

/* UnmeasuredFeet._alone */
static int carries_alone(Scene *scene, const Seen *seen, int foot)
{
    const ContactLimits *limits = &scene->feet->limits;
    const double floor_m = isnan(scene->floor_m)         ? scene->feet->floor_m
                           : isnan(scene->feet->floor_m) ? scene->floor_m
                                                         : lesser(scene->floor_m, scene->feet->floor_m);
    if (!scene->may_bear[foot] || !touches(scene, foot, floor_m, limits->alone_height_m, limits->alone_speed_m_s))
        return 0;
    for (int k = 0; k < scene->feet->plates; k++)
        if (reads_nothing(scene, seen, k) && !scene->feet->plate[k].known &&
            plate_before(scene, k)[PRESSED_BY] != 1 - foot)
            return 0;
    return 1;
}

/* unmeasured._acceleration and rules.falls */
static int falls(const Scene *scene, const Seen *seen)
{
    const double x = seen->q[3], y = seen->q[4], z = seen->q[5], w = seen->q[6];
    const double up[3] = {2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)};
    double rise[3];
    cross(seen->v + 3, seen->v, rise);
    for (int i = 0; i < 3; i++)
        rise[i] += seen->a[i];
    return dot3(up, rise) < scene->feet->limits.fall_m_s2;
}

/* unmeasured._near and rules.Touch.nearness */
static double near_of(Scene *scene, int foot, double height, double speed)
{
    double least = 0.0;
    if (isnan(scene->floor_m))
        return 0.0;
    for (int k = 0; k < SOLE; k++) {
        const double *point = scene->motion.sole[foot][k];
        const double high = greater(point[2] - scene->floor_m, 0.0) / height;
        const double fast = speed_of(&scene->motion, foot, point, scene->floor_m_s) / speed;
        least = k ? lesser(least, high * high + fast * fast) : high * high + fast * fast;
    }
    return exp(-0.5 * least);
}

/* Feet that carry the body if both seem to be in the air and nothing else carries it: UnmeasuredFeet.decide */
static void find_carrying(Scene *scene, const Seen *seen, const double *after)
{
    int *carries = scene->carries;
    if (scene->unloaded + scene->silent == scene->feet->plates)
        for (int f = 0; f < FEET; f++)
            carries[f] = carries_alone(scene, seen, f);
    if (carries[RIGHT] || carries[LEFT] || !scene->may_bear[RIGHT] || !scene->may_bear[LEFT])
        return;
    if (falls(scene, seen) && !movement_held_up(scene->feet, after))
        return;
    const double height[FEET] = {height_of(scene, RIGHT), height_of(scene, LEFT)};
    for (int f = 0; f < FEET; f++)
        carries[f] = height[f] <= lesser(height[RIGHT], height[LEFT]) + scene->feet->limits.lower_m;
}

/* UnmeasuredFeet.decide, of feet that no plate reads */
static void decide_elsewhere(Scene *scene, const Seen *seen, double *after, double *near)
{
    const ContactLimits *limits = &scene->feet->limits;
    int *carries = scene->carries;
    for (int f = 0; f < FEET; f++) {
        scene->may_bear[f] = scene->kind[f] == AIR && !watched(scene, seen, f);
        after[TOUCHING + f] = touched_for(scene, seen, f);
        carries[f] = scene->may_bear[f] && after[TOUCHING + f] > limits->stand_after_s;
    }
    const int in_air = scene->kind[RIGHT] == AIR && scene->kind[LEFT] == AIR && !seen->supported;
    if (in_air && !carries[RIGHT] && !carries[LEFT])
        find_carrying(scene, seen, after);
    const int flies = in_air && !carries[RIGHT] && !carries[LEFT], alone = flies && !scene->unloaded;
    after[AIRBORNE] = flies ? after[AIRBORNE] + 1.0 : 0.0;
    for (int f = 0; f < FEET; f++)
        if (scene->may_bear[f] && !carries[f])
            near[f] = near_of(scene, f, alone ? limits->alone_height_m : limits->stand_height_m,
                              alone ? limits->alone_speed_m_s : limits->stand_speed_m_s);
}

/* True if a memory's counts stay within it. */
static int is_memory(const Feet *feet, const double *memory)
{
    for (int i = FRAMES; i < HEAD; i++)
        if (!(memory[i] >= 0.0 && memory[i] <= (i == FRAMES ? feet->window : memory[FRAMES])))
            return 0;
    return 1;
}

int mbkf_decide_contact(Feet *feet, const double *q, const double *v, const double *a, const double *wrench,
                        int supported, const double *before, double *after, double *foot_wrench, double *middles,
                        double *below, double *soles, double *pelvis, double *near, double *floor_velocity)
{
    const Seen seen = {q, v, a, wrench, supported};
    Scene scene = {.feet = feet, .before = before};
    if (!is_memory(feet, before)) {
        refuse("the memory belongs to other feet: its counts exceed it");
        return 0;
    }
    near[RIGHT] = near[LEFT] = 0.0;
    memset(after, 0, sizeof *after * feet->memory);
    feet_at(feet, q, v, &scene.motion);
    int flags = assign_plates(&scene, &seen, after, foot_wrench, below);
    find_floor(&scene, after);
    after[TOUCHING] = after[TOUCHING + 1] = 0.0;
    if (scene.kind[RIGHT] == AIR || scene.kind[LEFT] == AIR)
        decide_elsewhere(&scene, &seen, after, near);
    else
        after[AIRBORNE] = 0.0;
    for (int f = 0; f < FEET; f++) {
        double (*sole)[3] = scene.motion.sole[f];
        const double lowest = after[TOUCHING + f] > 0.0 ? before[LOWEST_BALL + f] : INFINITY;
        after[LOWEST_BALL + f] = lesser(sole[1][2], lowest);
        for (int i = 0; i < 3; i++)
            middles[3 * f + i] = 0.5 * (sole[0][i] + sole[2][i]);
        flags |= ((scene.carries[f] ? UNMEASURED : scene.kind[f]) + 1) << 2 * f;
    }
    memcpy(soles, scene.motion.sole, sizeof scene.motion.sole);
    memcpy(pelvis, scene.motion.pelvis, sizeof scene.motion.pelvis);
    memcpy(floor_velocity, scene.floor_m_s, sizeof scene.floor_m_s);
    if (near[RIGHT] != 0.0 || near[LEFT] != 0.0 || scene.floor_m_s[0] != 0.0 || scene.floor_m_s[1] != 0.0)
        flags |= MOVING_OR_NEAR;
    return flags | (scene.carries[RIGHT] && scene.carries[LEFT] ? ON_OPEN_FLOOR : 0);
}
