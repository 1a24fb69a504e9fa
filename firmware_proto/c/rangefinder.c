#include "rangefinder.h"

static const struct rangefinder_shot light_was_off = {0, 0, BP_SHOT_STATUS_LASER_OFF};
static const struct rangefinder_shot took_too_long = {0, 0, BP_SHOT_STATUS_DEVICE_ERROR};

static struct rangefinder *rangefinder_of(struct board *board)
{
    return (struct rangefinder *)board;
}

static void answer(struct rangefinder *rangefinder, uint16_t seq, struct rangefinder_shot measured)
{
    const struct bp_shot shot = {
        .board_us = rangefinder->shot_us,
        .range_mm = measured.status == BP_SHOT_STATUS_OK ? measured.range_mm : 0,
        .strength = measured.strength,
        .status = measured.status,
    };
    uint8_t payload[BP_SHOT_SIZE];
    bp_pack_shot(&shot, payload);
    outbox_reply(&rangefinder->board.outbox, BP_SHOOT_TYPE, seq, payload, sizeof payload);
}

static void finish(struct rangefinder *rangefinder, struct rangefinder_shot shot)
{
    rangefinder->shooting = false;
    answer(rangefinder, rangefinder->shoot_seq, shot);
}

static enum board_outcome shoot(struct rangefinder *rangefinder, const struct bp_frame *request)
{
    const struct rangefinder_hal *hal = rangefinder->hal;
    const uint64_t now_us = rangefinder->board.now_us;
    struct bp_shoot shoot;
    if (rangefinder->shooting)
        return BOARD_BUSY;
    if (!bp_unpack_shoot(request->payload, request->size, &shoot) || shoot.timeout_ms == 0)
        return BOARD_IMPOSSIBLE;
    rangefinder->shot_us = now_us;
    if (!rangefinder->lit) {
        answer(rangefinder, request->seq, light_was_off);
        return BOARD_ANSWERED;
    }
    rangefinder->shooting = true;
    rangefinder->shoot_seq = request->seq;
    rangefinder->patience_us = now_us + shoot.timeout_ms * (uint64_t)1000;
    rangefinder->ask_us = hal->shoot(hal->context, now_us);
    return BOARD_LATER;
}

static void halt(struct board *board)
{
    struct rangefinder *rangefinder = rangefinder_of(board);
    rangefinder->lit = false;
    rangefinder->hal->light(rangefinder->hal->context, false);
    if (rangefinder->shooting)
        finish(rangefinder, light_was_off);
}

static enum board_outcome set_laser(struct rangefinder *rangefinder, const struct bp_frame *request)
{
    struct bp_set_laser laser;
    if (!bp_unpack_set_laser(request->payload, request->size, &laser) || laser.on > 1)
        return BOARD_IMPOSSIBLE;
    if (laser.on == 0) {
        halt(&rangefinder->board);
        return BOARD_DONE;
    }
    rangefinder->lit = true;
    rangefinder->hal->light(rangefinder->hal->context, true);
    return BOARD_DONE;
}

static enum board_outcome handle(struct board *board, const struct bp_frame *request)
{
    switch (request->type) {
    case BP_SET_LASER_TYPE:
        return set_laser(rangefinder_of(board), request);
    case BP_SHOOT_TYPE:
        return shoot(rangefinder_of(board), request);
    default:
        return BOARD_UNKNOWN;
    }
}

static void advance(struct board *board)
{
    (void)board; /* nothing moves beneath this board */
}

static void observe(struct board *board)
{
    struct rangefinder *rangefinder = rangefinder_of(board);
    const struct rangefinder_hal *hal = rangefinder->hal;
    struct rangefinder_shot shot;
    if (rangefinder->shooting && rangefinder->ask_us <= board->now_us &&
        hal->result(hal->context, board->now_us, &shot, &rangefinder->ask_us))
        finish(rangefinder, shot);
    if (rangefinder->shooting && rangefinder->patience_us <= board->now_us)
        finish(rangefinder, took_too_long);
}

static void report(struct board *board)
{
    (void)board; /* the status says it all */
}

static uint64_t next_us(const struct board *board)
{
    const struct rangefinder *rangefinder = (const struct rangefinder *)board;
    if (!rangefinder->shooting)
        return BOARD_NEVER;
    return rangefinder->ask_us < rangefinder->patience_us ? rangefinder->ask_us : rangefinder->patience_us;
}

static const struct board_device device = {&bp_rangefinder, handle, advance, observe, report, halt, halt, next_us};

void rangefinder_power_up(struct rangefinder *rangefinder, const struct rangefinder_hal *hal,
                          const struct board_line *line, uint32_t boot_id)
{
    rangefinder->hal = hal;
    rangefinder->shot_us = rangefinder->ask_us = rangefinder->patience_us = 0;
    rangefinder->shoot_seq = 0;
    rangefinder->shooting = rangefinder->lit = false;
    board_power_up(&rangefinder->board, &device, line, boot_id);
}
