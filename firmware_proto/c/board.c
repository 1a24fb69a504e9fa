#include "board.h"

#include "checksum.h"

#define US_PER_MS 1000u

/* State */

uint8_t board_state(const struct board *board)
{
    return board->faults != 0 ? (uint8_t)BP_BOARD_STATE_FAULT : board->beneath;
}

static void rest(struct board *board, bool cut)
{
    board->deadline_us = BOARD_NEVER;
    if (board->beneath == BP_BOARD_STATE_ARMED)
        board->beneath = BP_BOARD_STATE_CONFIGURED;
    if (cut)
        board->device->cut(board);
    else
        board->device->halt(board);
}

void board_latch(struct board *board, uint16_t faults, bool cut)
{
    board->faults |= faults;
    rest(board, cut);
}

void board_latch_broken(struct board *board, uint16_t faults)
{
    const uint16_t anew = faults & (uint16_t)~board->faults;
    if (anew != 0)
        board_latch(board, anew, (anew & BP_FAULT_MOTOR) != 0);
}

void board_grant(struct board *board, uint16_t ttl_ms)
{
    const uint16_t granted_ms = ttl_ms < board->ttl_max_ms ? ttl_ms : board->ttl_max_ms;
    board->deadline_us = board->now_us + (uint64_t)granted_ms * US_PER_MS;
}

static void tell_status(struct board *board)
{
    const struct bp_receiver *receiver = &board->receiver;
    board->told = true;
    board->told_state = board_state(board);
    board->told_faults = board->faults;
    const struct bp_board_status status = {
        .board_us = board->now_us,
        .state = board->told_state,
        .faults = board->told_faults,
        .crc_errors = receiver->crc_errors,
        .cobs_errors = receiver->cobs_errors,
        .length_errors = (uint16_t)(receiver->length_errors + board->wrong_sizes),
    };
    uint8_t payload[BP_BOARD_STATUS_SIZE];
    bp_pack_board_status(&status, payload);
    outbox_tell(&board->outbox, BP_BOARD_STATUS_TYPE, payload, sizeof payload);
}

static void tell_change(struct board *board)
{
    const bool same = board->told && board->told_state == board_state(board) && board->told_faults == board->faults;
    if (board->outbox.telling && !same)
        tell_status(board);
}

/* Requests that every device takes */

static enum board_outcome hello(struct board *board, const struct bp_frame *request)
{
    struct bp_hello hello;
    (void)bp_unpack_hello(request->payload, request->size, &hello);
    rest(board, false);
    board->beneath = hello.major == BP_PROTOCOL_MAJOR ? BP_BOARD_STATE_IDENTIFIED : BP_BOARD_STATE_BOOT;
    board->telemetry_us = BOARD_NEVER;
    outbox_new_session(&board->outbox);
    const struct bp_device *self = board->device->self;
    const struct bp_hello_reply reply = {
        .major = BP_PROTOCOL_MAJOR,
        .minor = BP_PROTOCOL_MINOR,
        .nonce = hello.nonce,
        .dictionary_size = self->dictionary_size,
        .dictionary_crc32 = self->dictionary_crc32,
        .boot_id = board->boot_id,
        .clock_hz = BOARD_CLOCK_HZ,
    };
    uint8_t payload[BP_HELLO_REPLY_SIZE];
    bp_pack_hello_reply(&reply, payload);
    outbox_reply(&board->outbox, request->type, request->seq, payload, sizeof payload);
    return BOARD_ANSWERED;
}

static enum board_outcome ping(struct board *board, const struct bp_frame *request)
{
    struct bp_ping ping;
    (void)bp_unpack_ping(request->payload, request->size, &ping);
    const struct bp_pong pong = {ping.host_us, board->now_us};
    uint8_t payload[BP_PONG_SIZE];
    bp_pack_pong(&pong, payload);
    outbox_reply(&board->outbox, request->type, request->seq, payload, sizeof payload);
    return BOARD_ANSWERED;
}

static enum board_outcome identify(struct board *board, const struct bp_frame *request)
{
    const struct bp_device *self = board->device->self;
    struct bp_identify identify;
    (void)bp_unpack_identify(request->payload, request->size, &identify);
    struct bp_identify_reply reply = {.offset = identify.offset};
    for (size_t i = 0; i < BP_DICTIONARY_CHUNK && identify.offset + i < self->dictionary_size; i++)
        reply.data[i] = self->dictionary[identify.offset + i];
    uint8_t payload[BP_IDENTIFY_REPLY_SIZE];
    bp_pack_identify_reply(&reply, payload);
    outbox_reply(&board->outbox, request->type, request->seq, payload, sizeof payload);
    return BOARD_ANSWERED;
}

static enum board_outcome configure(struct board *board, const struct bp_frame *request)
{
    struct bp_configure configure;
    (void)bp_unpack_configure(request->payload, request->size, &configure);
    if (configure.telemetry_ms == 0 || configure.ttl_max_ms == 0)
        return BOARD_IMPOSSIBLE;
    rest(board, false);
    board->beneath = BP_BOARD_STATE_CONFIGURED;
    board->period_us = configure.telemetry_ms * US_PER_MS;
    board->telemetry_us = board->now_us + board->period_us;
    board->outbox.telling = true;
    board->told = false;
    board->ttl_max_ms = configure.ttl_max_ms;
    const struct bp_configure_reply reply = {BP_RESULT_OK, bp_crc32(request->payload, request->size)};
    uint8_t payload[BP_CONFIGURE_REPLY_SIZE];
    bp_pack_configure_reply(&reply, payload);
    outbox_reply(&board->outbox, request->type, request->seq, payload, sizeof payload);
    return BOARD_ANSWERED;
}

static enum board_outcome execute(struct board *board, const struct bp_frame *request)
{
    switch (request->type) {
    case BP_HELLO_TYPE:
        return hello(board, request);
    case BP_PING_TYPE:
        return ping(board, request);
    case BP_IDENTIFY_TYPE:
        return identify(board, request);
    case BP_CONFIGURE_TYPE:
        return configure(board, request);
    case BP_ARM_TYPE:
        board->beneath = BP_BOARD_STATE_ARMED;
        return BOARD_DONE;
    case BP_CLEAR_TYPE:
        rest(board, false);
        board->faults = BP_FAULT_NONE;
        return BOARD_DONE;
    case BP_DISARM_TYPE:
    case BP_STOP_TYPE:
        rest(board, false);
        return BOARD_DONE;
    case BP_KILL_TYPE:
        board_latch(board, BP_FAULT_KILLED, true);
        return BOARD_DONE;
    default:
        return board->device->handle(board, request);
    }
}

/* Receiving */

static bool allows(const struct board *board, const struct bp_rule *rule)
{
    const bool beneath = (rule->states >> board->beneath & 1) != 0;
    const bool faulted = (rule->states >> BP_BOARD_STATE_FAULT & 1) != 0;
    return beneath && (board->faults == 0 || faulted);
}

static void respond(struct board *board, const struct bp_frame *request, enum board_outcome outcome)
{
    if (outcome == BOARD_LATER)
        outbox_postpone(&board->outbox, request->type, request->seq);
    else if (outcome != BOARD_ANSWERED)
        outbox_result(&board->outbox, request->type, request->seq, (uint8_t)outcome);
}

static void take(struct board *board, const struct bp_frame *frame)
{
    struct outbox *outbox = &board->outbox;
    const struct bp_rule *rule = outbox_rule(outbox, frame->type);
    if (rule == NULL) {
        if (frame->type < BP_REQUEST_END)
            outbox_result(outbox, frame->type, frame->seq, BP_RESULT_UNKNOWN_TYPE);
    } else if (frame->size != rule->size) {
        board->wrong_sizes++;
        outbox_result(outbox, frame->type, frame->seq, BP_RESULT_BAD_LENGTH);
    } else if (!outbox_repeat(outbox, frame->type, frame->seq)) {
        respond(board, frame, allows(board, rule) ? execute(board, frame) : BOARD_WRONG_STATE);
    }
}

void board_receive(struct board *board, const uint8_t *bytes, size_t size, uint64_t now_us)
{
    struct bp_frame frame;
    board_advance(board, now_us);
    for (size_t i = 0; i < size; i++) {
        if (!bp_receive(&board->receiver, bytes[i], &frame))
            continue;
        take(board, &frame);
        board->device->observe(board);
        tell_change(board);
    }
}

/* Time */

static void pass_time(struct board *board, uint64_t to_us)
{
    board->now_us = to_us;
    board->device->advance(board);
    board->device->observe(board);
    if (board->deadline_us <= to_us)
        board_latch(board, BP_FAULT_DEADMAN, false);
    if (board->telemetry_us <= to_us) {
        board->telemetry_us += board->period_us;
        tell_status(board);
        board->device->report(board);
    }
    tell_change(board);
}

uint64_t board_next_us(const struct board *board)
{
    uint64_t next_us = board->device->next_us(board);
    if (board->telemetry_us < next_us)
        next_us = board->telemetry_us;
    return board->deadline_us < next_us ? board->deadline_us : next_us;
}

void board_advance(struct board *board, uint64_t now_us)
{
    for (uint64_t due_us = board_next_us(board); due_us <= now_us; due_us = board_next_us(board))
        pass_time(board, due_us);
    if (now_us > board->now_us)
        pass_time(board, now_us);
}

void board_power_up(struct board *board, const struct board_device *device, const struct board_line *line,
                    uint32_t boot_id)
{
    board->device = device;
    board->boot_id = boot_id;
    board->now_us = 0;
    board->deadline_us = BOARD_NEVER;
    board->period_us = 0;
    board->ttl_max_ms = board->wrong_sizes = board->faults = 0;
    board->beneath = BP_BOARD_STATE_BOOT;
    board->told = false;
    board->telemetry_us = BOARD_NEVER;
    outbox_power_up(&board->outbox, line, device->self);
    bp_receiver_reset(&board->receiver);
    device->cut(board);
}
