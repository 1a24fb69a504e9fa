/* What every board does: session, states, repeats, arming, deadman, telemetry, as PROTOCOL.md says.
 *
 * A board does no input or output of its own: bytes and times go in, bytes go out through its line. It lives in its
 * own microseconds since boot and allocates nothing. A device (drive.h, pantilt.h, rangefinder.h) begins with a struct
 * board and adds what it can do, as a table of functions. */
#ifndef BOARD_H
#define BOARD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "frame.h"
#include "outbox.h"

#define BOARD_NEVER UINT64_MAX
#define BOARD_CLOCK_HZ 1000000u

struct board;

/* What became of a request. */
enum board_outcome {
    BOARD_DONE = BP_RESULT_OK,
    BOARD_WRONG_STATE = BP_RESULT_WRONG_STATE,
    BOARD_IMPOSSIBLE = BP_RESULT_BAD_VALUE,
    BOARD_BUSY = BP_RESULT_BUSY,
    BOARD_UNKNOWN = BP_RESULT_UNKNOWN_TYPE,
    BOARD_ANSWERED = 0x100, /* the handler has sent the request's own reply */
    BOARD_LATER             /* it will */
};

/* What a device adds. All are called at the board's present time. */
struct board_device {
    const struct bp_device *self;
    enum board_outcome (*handle)(struct board *board, const struct bp_frame *request);
    void (*advance)(struct board *board);            /* let time pass beneath the board */
    void (*observe)(struct board *board);            /* look what was done, what was hit, what broke */
    void (*report)(struct board *board);             /* tell the periodic telemetry */
    void (*halt)(struct board *board);               /* ramp down, switch off */
    void (*cut)(struct board *board);                /* stop at once, switch off */
    uint64_t (*next_us)(const struct board *board);  /* when something falls due, or BOARD_NEVER */
};

struct board {
    const struct board_device *device;
    uint64_t now_us;
    uint64_t deadline_us;  /* when the deadman falls; BOARD_NEVER while nothing moves */
    uint64_t telemetry_us; /* when the next reports are due */
    uint32_t period_us;    /* of the reports */
    uint32_t boot_id;
    uint16_t ttl_max_ms;
    uint16_t wrong_sizes;
    uint16_t faults;
    uint8_t beneath; /* the state that FAULT may lie over */
    bool told;       /* whether the host was told of a state in this session, and which */
    uint8_t told_state;
    uint16_t told_faults;
    struct outbox outbox;
    struct bp_receiver receiver;
};

/* For the owner of a board. */

/* Take bytes from the host, at the board's time. */
void board_receive(struct board *board, const uint8_t *bytes, size_t size, uint64_t now_us);

/* Let time pass; what falls due on the way happens in order, each at its own time. */
void board_advance(struct board *board, uint64_t now_us);

/* When board_advance must be called at the latest, or BOARD_NEVER. */
uint64_t board_next_us(const struct board *board);

/* Where in its life the board is: a bp_board_state. */
uint8_t board_state(const struct board *board);

/* For devices. */

/* Begin as after power came, at rest. boot_id differs at every boot. */
void board_power_up(struct board *board, const struct board_device *device, const struct board_line *line,
                    uint32_t boot_id);

/* Start the deadman: unless renewed or ended by then, the motion is a fault. */
void board_grant(struct board *board, uint16_t ttl_ms);

/* Latch bp_faults: disarm, and ramp down or cut. */
void board_latch(struct board *board, uint16_t faults, bool cut);

/* Latch what the hardware says is wrong, MOTOR with a cut, the rest with a ramp; what is latched stays as it is. */
void board_latch_broken(struct board *board, uint16_t faults);

#endif
