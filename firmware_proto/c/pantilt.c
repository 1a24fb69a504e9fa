#include "pantilt.h"

static struct pantilt *pantilt_of(struct board *board)
{
    return (struct pantilt *)board;
}

static bool reaches(const struct bp_limits *limits, const struct bp_aim *aim)
{
    return limits->pan_min_tenth_mrad <= aim->pan_tenth_mrad && aim->pan_tenth_mrad <= limits->pan_max_tenth_mrad &&
           limits->tilt_min_tenth_mrad <= aim->tilt_tenth_mrad && aim->tilt_tenth_mrad <= limits->tilt_max_tenth_mrad;
}

static enum board_outcome start_aim(struct pantilt *pantilt, const struct bp_frame *request)
{
    const struct pantilt_hal *hal = pantilt->hal;
    struct bp_aim aim;
    if (!bp_unpack_aim(request->payload, request->size, &aim) || aim.ttl_ms == 0 || !reaches(&hal->limits, &aim))
        return BOARD_IMPOSSIBLE;
    const struct pantilt_angles wanted = {aim.pan_tenth_mrad, aim.tilt_tenth_mrad};
    hal->aim(hal->context, wanted);
    pantilt->motion = BP_MOTION_TURNING;
    pantilt->aim_seq = request->seq;
    board_grant(&pantilt->board, aim.ttl_ms);
    return BOARD_DONE;
}

static enum board_outcome read_aim(struct pantilt *pantilt, const struct bp_frame *request)
{
    const struct pantilt_angles angles = pantilt->hal->angles(pantilt->hal->context);
    const struct bp_aim_readback readback = {
        .board_us = pantilt->board.now_us,
        .pan_tenth_mrad = angles.pan_tenth_mrad,
        .tilt_tenth_mrad = angles.tilt_tenth_mrad,
        .aim_seq = pantilt->aim_seq,
        .moving = pantilt->motion,
    };
    uint8_t payload[BP_AIM_READBACK_SIZE];
    bp_pack_aim_readback(&readback, payload);
    outbox_reply(&pantilt->board.outbox, request->type, request->seq, payload, sizeof payload);
    return BOARD_ANSWERED;
}

static enum board_outcome read_limits(struct pantilt *pantilt, const struct bp_frame *request)
{
    uint8_t payload[BP_LIMITS_SIZE];
    bp_pack_limits(&pantilt->hal->limits, payload);
    outbox_reply(&pantilt->board.outbox, request->type, request->seq, payload, sizeof payload);
    return BOARD_ANSWERED;
}

static enum board_outcome handle(struct board *board, const struct bp_frame *request)
{
    switch (request->type) {
    case BP_AIM_TYPE:
        return start_aim(pantilt_of(board), request);
    case BP_READ_AIM_TYPE:
        return read_aim(pantilt_of(board), request);
    case BP_READ_LIMITS_TYPE:
        return read_limits(pantilt_of(board), request);
    default:
        return BOARD_UNKNOWN;
    }
}

static void halt(struct board *board)
{
    struct pantilt *pantilt = pantilt_of(board);
    pantilt->motion = BP_MOTION_HALTED;
    pantilt->hal->halt(pantilt->hal->context);
}

static void advance(struct board *board)
{
    const struct pantilt_hal *hal = pantilt_of(board)->hal;
    hal->advance(hal->context, board->now_us);
}

static void report(struct board *board)
{
    const struct pantilt *pantilt = pantilt_of(board);
    const struct pantilt_angles angles = pantilt->hal->angles(pantilt->hal->context);
    const struct bp_aim_report report = {
        .board_us = board->now_us,
        .pan_tenth_mrad = angles.pan_tenth_mrad,
        .tilt_tenth_mrad = angles.tilt_tenth_mrad,
        .aim_seq = pantilt->aim_seq,
        .moving = pantilt->motion,
    };
    uint8_t payload[BP_AIM_REPORT_SIZE];
    bp_pack_aim_report(&report, payload);
    outbox_tell(&board->outbox, BP_AIM_REPORT_TYPE, payload, sizeof payload);
}

static void observe(struct board *board)
{
    struct pantilt *pantilt = pantilt_of(board);
    const struct pantilt_hal *hal = pantilt->hal;
    if (pantilt->motion == BP_MOTION_TURNING && hal->arrives_us(hal->context) <= board->now_us) {
        pantilt->motion = BP_MOTION_DONE;
        board->deadline_us = BOARD_NEVER;
        report(board);
    }
    board_latch_broken(board, hal->broken(hal->context));
}

static uint64_t next_us(const struct board *board)
{
    const struct pantilt *pantilt = (const struct pantilt *)board;
    if (pantilt->motion != BP_MOTION_TURNING)
        return BOARD_NEVER;
    const uint64_t arrives_us = pantilt->hal->arrives_us(pantilt->hal->context);
    return arrives_us == PANTILT_AT_REST ? BOARD_NEVER : arrives_us;
}

static const struct board_device device = {&bp_pantilt, handle, advance, observe, report, halt, halt, next_us};

void pantilt_power_up(struct pantilt *pantilt, const struct pantilt_hal *hal, const struct board_line *line,
                      uint32_t boot_id)
{
    pantilt->hal = hal;
    pantilt->aim_seq = 0;
    pantilt->motion = BP_MOTION_HALTED;
    board_power_up(&pantilt->board, &device, line, boot_id);
}
