#include "frame.h"

#include "checksum.h"
#include "little_endian.h"

#define COBS_BLOCK 255u /* the code of 254 bytes that no zero follows */

void bp_receiver_reset(struct bp_receiver *receiver)
{
    receiver->crc_errors = receiver->cobs_errors = receiver->length_errors = receiver->size = 0;
}

/* Undo COBS in place, where what is written never overtakes what is read; false if a code points past the end. */
static bool cobs_decode(uint8_t *packet, size_t size, size_t *decoded)
{
    size_t from = 0, to = 0;
    while (from < size) {
        const uint8_t code = packet[from];
        if (code > size - from)
            return false;
        bp_copy(packet + to, packet + from + 1, code - 1u);
        to += code - 1u;
        from += code;
        if (code < COBS_BLOCK && from < size)
            packet[to++] = 0;
    }
    *decoded = to;
    return true;
}

static bool decode(struct bp_receiver *receiver, size_t packet_size, struct bp_frame *frame)
{
    uint8_t *packet = receiver->packet;
    size_t size = 0;
    if (packet_size > BP_PACKET_MAX) {
        receiver->length_errors++;
        return false;
    }
    if (!cobs_decode(packet, packet_size, &size)) {
        receiver->cobs_errors++;
        return false;
    }
    if (size < BP_FRAME_MIN || size > BP_FRAME_MAX) {
        receiver->length_errors++;
        return false;
    }
    if (bp_crc16(packet, size) != 0) {
        receiver->crc_errors++;
        return false;
    }
    if (packet[1] != 0) {
        receiver->length_errors++;
        return false;
    }
    frame->type = packet[0];
    frame->seq = bp_get_u16(packet + 2);
    frame->size = size - BP_FRAME_MIN;
    frame->payload = packet + BP_HEADER_SIZE;
    return true;
}

bool bp_receive(struct bp_receiver *receiver, uint8_t byte, struct bp_frame *frame)
{
    const uint16_t size = receiver->size;
    if (byte != 0) {
        if (size < BP_PACKET_MAX)
            receiver->packet[size] = byte;
        if (size <= BP_PACKET_MAX)
            receiver->size++;
        return false;
    }
    receiver->size = 0;
    return size != 0 && decode(receiver, size, frame);
}

/* Where COBS of a frame is being written. */
struct stuffing {
    uint8_t *code; /* place of the code of the present run */
    uint8_t *next;
};

static void stuff(struct stuffing *stuffing, const uint8_t *data, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        if (data[i] != 0) {
            *stuffing->next++ = data[i];
            continue;
        }
        *stuffing->code = (uint8_t)(stuffing->next - stuffing->code);
        stuffing->code = stuffing->next++;
    }
}

size_t bp_encode(uint8_t type, uint16_t seq, const uint8_t *payload, size_t size, uint8_t *wire)
{
    /* The frame is laid out behind the place of the zero and the first code, to be summed, then stuffed in place:
     * a byte never moves, since each zero becomes the code of what follows it. */
    uint8_t *frame = wire + 2;
    frame[0] = type;
    frame[1] = 0;
    bp_put_u16(frame + 2, seq);
    bp_copy(frame + BP_HEADER_SIZE, payload, size);
    const uint16_t crc = bp_crc16(frame, BP_HEADER_SIZE + size);
    frame[BP_HEADER_SIZE + size] = (uint8_t)(crc >> 8);
    frame[BP_HEADER_SIZE + size + 1] = (uint8_t)(crc & 0xFFu);
    struct stuffing stuffing = {wire + 1, wire + 2};
    stuff(&stuffing, frame, size + BP_FRAME_MIN);
    *stuffing.code = (uint8_t)(stuffing.next - stuffing.code);
    wire[0] = 0;
    *stuffing.next = 0;
    return BP_WIRE_SIZE(size);
}
