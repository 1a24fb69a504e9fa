/* What a board puts on the wire: replies, which it remembers, and telemetry, which it counts. */
#ifndef OUTBOX_H
#define OUTBOX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "devices.h"

#define OUTBOX_TELEMETRY_TYPES 8u /* from BP_TELEMETRY_START on, how many are counted */

/* Where a board's bytes go. */
struct board_line {
    void *context;
    /* Send all of a frame or, if there is no room for it, nothing: the host asks again. Never wait. */
    void (*write)(void *context, const uint8_t *bytes, size_t size);
};

/* The last answer to a request that must not be done twice. */
struct outbox_memory {
    uint16_t seq;
    bool known;
    bool pending; /* the answer is still to come */
    uint8_t type;
    uint8_t size;
    uint8_t payload[BP_REMEMBERED_SIZE];
};

struct outbox {
    const struct board_line *line;
    const struct bp_device *self;
    bool telling; /* whether telemetry goes out */
    uint16_t counters[OUTBOX_TELEMETRY_TYPES];
    struct outbox_memory remembered[BP_REMEMBERED_MAX];
};

void outbox_power_up(struct outbox *outbox, const struct board_line *line, const struct bp_device *self);

/* Forget what was answered, count from 0, and be silent until told otherwise. */
void outbox_new_session(struct outbox *outbox);

/* The rule of a request; NULL if this device knows no such request. */
const struct bp_rule *outbox_rule(const struct outbox *outbox, uint8_t request_type);

/* Send telemetry, if it goes out. */
void outbox_tell(struct outbox *outbox, uint8_t type, const uint8_t *payload, size_t size);

/* Answer a request with its own reply, and remember it if that must be. */
void outbox_reply(struct outbox *outbox, uint8_t request_type, uint16_t seq, const uint8_t *payload, size_t size);

/* Answer with Ack (BP_RESULT_OK) or with NACK (any other bp_result). */
void outbox_result(struct outbox *outbox, uint8_t request_type, uint16_t seq, uint8_t result);

/* Note that an answer is still to come: until then a repeat is not answered. */
void outbox_postpone(struct outbox *outbox, uint8_t request_type, uint16_t seq);

/* Answer a request as it was answered before; false if it was not the last of its type. */
bool outbox_repeat(struct outbox *outbox, uint8_t request_type, uint16_t seq);

#endif
