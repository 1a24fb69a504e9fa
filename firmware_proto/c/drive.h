/* The board of a synchro-drive base. */
#ifndef DRIVE_H
#define DRIVE_H

#include "board.h"

struct drive_velocity {
    int16_t speed_mmps;  /* translation along the heading */
    int16_t turn_mradps; /* rotation, counter-clockwise */
};

struct drive_counts {
    int32_t translate; /* encoder, forward positive; wraps */
    int32_t rotate;    /* encoder, counter-clockwise positive; wraps */
};

/* The base beneath the board. Every function gets the context; none may wait. */
struct drive_hal {
    void *context;
    void (*advance)(void *context, uint64_t now_us); /* time is now_us: run the ramps, read the encoders */
    void (*command)(void *context, struct drive_velocity wanted); /* ramp towards these velocities: ramp.h can */
    void (*cut)(void *context);                      /* cut the motors: no ramp */
    struct drive_counts (*counts)(void *context);
    struct drive_velocity (*velocity)(void *context); /* as measured */
    uint16_t (*bumpers)(void *context);   /* pressed ones; bit i at i * 22.5 degrees counter-clockwise of the heading */
    uint16_t (*battery_mv)(void *context);
    uint16_t (*broken)(void *context);    /* BP_FAULT_MOTOR, BP_FAULT_BATTERY: what is wrong at this moment */
};

struct drive {
    struct board board; /* first, so that a board's functions find their drive */
    const struct drive_hal *hal;
    uint16_t bumpers;
    bool wanted; /* there is a set-point that is not 0 */
    bool moving;
};

void drive_power_up(struct drive *drive, const struct drive_hal *hal, const struct board_line *line, uint32_t boot_id);

#endif
