/* The board of a pan/tilt head. */
#ifndef PANTILT_H
#define PANTILT_H

#include "board.h"

#define PANTILT_AT_REST 0u

struct pantilt_angles {
    int32_t pan_tenth_mrad;  /* counter-clockwise from straight ahead */
    int32_t tilt_tenth_mrad; /* up from level */
};

/* The head beneath the board. Every function gets the context; none may wait. */
struct pantilt_hal {
    void *context;
    struct bp_limits limits; /* mechanical */
    void (*advance)(void *context, uint64_t now_us);               /* time is now_us */
    void (*aim)(void *context, struct pantilt_angles wanted);      /* start turning there */
    void (*halt)(void *context);                                   /* stop turning where it is */
    struct pantilt_angles (*angles)(void *context);                /* as measured */
    /* When the head will be there: that time once it has come, or PANTILT_AT_REST. A head that cannot know says the
     * next moment at which to ask. */
    uint64_t (*arrives_us)(void *context);
    uint16_t (*broken)(void *context); /* BP_FAULT_MOTOR: what is wrong at this moment */
};

struct pantilt {
    struct board board; /* first, so that a board's functions find their head */
    const struct pantilt_hal *hal;
    uint16_t aim_seq;
    uint8_t motion; /* a bp_motion */
};

void pantilt_power_up(struct pantilt *pantilt, const struct pantilt_hal *hal, const struct board_line *line,
                      uint32_t boot_id);

#endif
