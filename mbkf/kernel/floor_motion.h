/* Velocity of the floor, and a body that does not fall; see floor_motion.c. */
#ifndef MBKF_FLOOR_MOTION_H
#define MBKF_FLOOR_MOTION_H

#include "feet.h"

/* A contact's memory as one array of numbers, laid out as mbkf/kernel/contact.py states. */
enum { SOLE_HEIGHT = 0, TOUCHING = 1, LOWEST_BALL = 3, AIRBORNE = 5, FRAMES = 6, RANKED = 7, HEAD = 9 };
enum { FOOT_OF_PLATE = 0, PRESSED = 1, PRESSED_BY = 3, PER_PLATE = 4, NEVER = -2 };

static inline int memory_length(const Feet *feet) { return HEAD + PER_PLATE * feet->plates + 7 * feet->window; }

/* Adds a frame: horizontal velocity of the lowest sole point, NaN where it is not near the floor, and the pelvis. */
void movement_add_frame(const Feet *feet, const double *before, const double *low, const double *pelvis, double *after);

/* Horizontal velocity of the floor; zero unless a belt is evident. */
void movement_velocity(const Feet *feet, const double *record, double *floor_m_s);

/* True if a body whose feet were both decided to be in the air did not fall. */
int movement_held_up(const Feet *feet, const double *record);

#endif
