/* The board of a laser rangefinder. */
#ifndef RANGEFINDER_H
#define RANGEFINDER_H

#include "board.h"

struct rangefinder_shot {
    uint32_t range_mm; /* along the beam; counts only if the status is OK */
    uint16_t strength;
    uint8_t status; /* a bp_shot_status: the instrument's own sentinels, translated */
};

/* The instrument beneath the board. Every function gets the context; none may wait. */
struct rangefinder_hal {
    void *context;
    void (*light)(void *context, bool on);              /* switch it; off also gives up a measurement under way */
    /* Start measuring, and say when to ask for the result first. */
    uint64_t (*shoot)(void *context, uint64_t now_us);
    /* Get the result of the measurement; false if there is none yet, and then when to ask again, later than now. */
    bool (*result)(void *context, uint64_t now_us, struct rangefinder_shot *shot, uint64_t *ask_us);
};

struct rangefinder {
    struct board board; /* first, so that a board's functions find their rangefinder */
    const struct rangefinder_hal *hal;
    uint64_t shot_us;     /* when the light was sent */
    uint64_t ask_us;      /* when to ask for the result */
    uint64_t patience_us; /* when to wait no longer */
    uint16_t shoot_seq;
    bool shooting;
    bool lit;
};

void rangefinder_power_up(struct rangefinder *rangefinder, const struct rangefinder_hal *hal,
                          const struct board_line *line, uint32_t boot_id);

#endif
