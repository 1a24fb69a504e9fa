/* Written by `python -m firmware_proto.generate` from the declarations beside this folder: edit those. */
#ifndef BP_DEVICES_H
#define BP_DEVICES_H

#include "messages.h"

#define BP_NOT_REMEMBERED 0xFFu
#define BP_REMEMBERED_MAX 6u /* how many deduplicated requests a device has at most */
#define BP_REMEMBERED_SIZE 15u /* payload of their longest answer [bytes] */

/* How a board treats one request. */
struct bp_rule {
    uint8_t type;
    uint8_t size;     /* of its payload [bytes], exactly */
    uint8_t states;   /* bit i: allowed in bp_board_state i; where FAULT lies over a state, both must allow it */
    uint8_t remember; /* place of its last answer in a board's memory, or BP_NOT_REMEMBERED */
};

/* What a board knows of itself. */
struct bp_device {
    const struct bp_rule *rules;
    const uint8_t *dictionary; /* compressed */
    uint32_t dictionary_crc32;
    uint16_t dictionary_size; /* [bytes] */
    uint8_t rule_count;
};

extern const struct bp_device bp_drive;
extern const struct bp_device bp_pantilt;
extern const struct bp_device bp_rangefinder;

#endif
