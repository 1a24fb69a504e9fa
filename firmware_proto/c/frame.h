/* Frames on the wire: 00 COBS(type u8 | flags u8 | seq u16 | payload | crc u16 big-endian) 00. */
#ifndef BP_FRAME_H
#define BP_FRAME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "messages.h"

#define BP_HEADER_SIZE 4u
#define BP_FRAME_MIN (BP_HEADER_SIZE + 2u)
#define BP_FRAME_MAX (BP_HEADER_SIZE + BP_PAYLOAD_MAX + 2u)
#define BP_WIRE_SIZE(payload_size) ((payload_size) + BP_FRAME_MIN + 3u) /* a COBS code more, and both zeros */

/* A frame whose checksum was right. */
struct bp_frame {
    uint8_t type;
    uint16_t seq;
    size_t size;            /* of the payload [bytes] */
    const uint8_t *payload; /* valid until the receiver takes its next byte */
};

/* Finds frames in a stream of bytes. Damage is counted, modulo 65536; memory is bounded. */
struct bp_receiver {
    uint16_t crc_errors;    /* packets with a wrong checksum */
    uint16_t cobs_errors;   /* packets that are no COBS */
    uint16_t length_errors; /* packets too short or too long, or with flags that this version does not know */
    uint16_t size;          /* of the packet so far; one more than BP_PACKET_MAX: too long */
    uint8_t packet[BP_PACKET_MAX];
};

void bp_receiver_reset(struct bp_receiver *receiver);

/* Take one byte; true if it completed a good frame. */
bool bp_receive(struct bp_receiver *receiver, uint8_t byte, struct bp_frame *frame);

/* Write a frame with at most BP_PAYLOAD_MAX bytes of payload; returns its BP_WIRE_SIZE(size). */
size_t bp_encode(uint8_t type, uint16_t seq, const uint8_t *payload, size_t size, uint8_t *wire);

#endif
