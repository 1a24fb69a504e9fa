/* A motion ramp, for motors that have none of their own: a speed that follows its goal at a bounded acceleration.
 *
 * One for each motor (translation in mm/s, rotation in mrad/s; units of speed, below). Exact, however unevenly time
 * is cut up: the speed is kept in millionths of a unit. */
#ifndef RAMP_H
#define RAMP_H

#include <stdint.h>

struct ramp {
    uint32_t acceleration; /* [units/s2] */
    uint16_t limit;        /* the goal is never farther from 0 [units] */
    int16_t goal;          /* [units] */
    int64_t millionths;    /* the speed now */
};

/* Go for a speed, as far as the limit allows. */
void ramp_head_for(struct ramp *ramp, int16_t goal);

/* Let time pass; returns what to set the motor to. */
int16_t ramp_advance(struct ramp *ramp, uint32_t elapsed_us);

/* Stand, at once. */
void ramp_cut(struct ramp *ramp);

#endif
