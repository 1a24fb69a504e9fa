#include "drive.h"

#define WATCH_US 10000u /* how often a moving base looks at its bumpers, on a fixed grid */

static struct drive *drive_of(struct board *board)
{
    return (struct drive *)board;
}

static enum board_outcome set_velocity(struct drive *drive, const struct bp_frame *request)
{
    struct bp_set_velocity wanted;
    if (!bp_unpack_set_velocity(request->payload, request->size, &wanted) || wanted.ttl_ms == 0)
        return BOARD_IMPOSSIBLE;
    const struct drive_velocity velocity = {wanted.speed_mmps, wanted.turn_mradps};
    drive->hal->command(drive->hal->context, velocity);
    drive->wanted = wanted.speed_mmps != 0 || wanted.turn_mradps != 0;
    drive->board.deadline_us = BOARD_NEVER;
    if (drive->wanted)
        board_grant(&drive->board, wanted.ttl_ms < BP_TTL_LIMIT_MS ? wanted.ttl_ms : (uint16_t)BP_TTL_LIMIT_MS);
    return BOARD_DONE;
}

static enum board_outcome handle(struct board *board, const struct bp_frame *request)
{
    return request->type == BP_SET_VELOCITY_TYPE ? set_velocity(drive_of(board), request) : BOARD_UNKNOWN;
}

static void halt(struct board *board)
{
    const struct drive_velocity standstill = {0, 0};
    struct drive *drive = drive_of(board);
    drive->wanted = false;
    drive->hal->command(drive->hal->context, standstill);
}

static void cut(struct board *board)
{
    struct drive *drive = drive_of(board);
    drive->wanted = false;
    drive->hal->cut(drive->hal->context);
}

static void advance(struct board *board)
{
    const struct drive_hal *hal = drive_of(board)->hal;
    hal->advance(hal->context, board->now_us);
}

static void tell_drive(struct drive *drive)
{
    const struct bp_drive_report report = {
        .board_us = drive->board.now_us,
        .battery_mv = drive->hal->battery_mv(drive->hal->context),
        .bumpers = drive->bumpers,
    };
    uint8_t payload[BP_DRIVE_REPORT_SIZE];
    bp_pack_drive_report(&report, payload);
    outbox_tell(&drive->board.outbox, BP_DRIVE_REPORT_TYPE, payload, sizeof payload);
}

static void tell_odometry(struct drive *drive)
{
    const struct drive_counts counts = drive->hal->counts(drive->hal->context);
    const struct drive_velocity velocity = drive->hal->velocity(drive->hal->context);
    const struct bp_odometry_report report = {
        .board_us = drive->board.now_us,
        .translate_counts = counts.translate,
        .rotate_counts = counts.rotate,
        .speed_mmps = velocity.speed_mmps,
        .turn_mradps = velocity.turn_mradps,
    };
    uint8_t payload[BP_ODOMETRY_REPORT_SIZE];
    bp_pack_odometry_report(&report, payload);
    outbox_tell(&drive->board.outbox, BP_ODOMETRY_REPORT_TYPE, payload, sizeof payload);
}

static void observe(struct board *board)
{
    struct drive *drive = drive_of(board);
    const struct drive_hal *hal = drive->hal;
    const struct drive_velocity velocity = hal->velocity(hal->context);
    const bool was_moving = drive->moving;
    drive->moving = drive->wanted || velocity.speed_mmps != 0 || velocity.turn_mradps != 0;
    const uint16_t pressed = hal->bumpers(hal->context);
    const uint16_t newly = pressed & (uint16_t)~drive->bumpers;
    if (pressed != drive->bumpers) {
        drive->bumpers = pressed;
        tell_drive(drive);
    }
    if (newly != 0 && (was_moving || drive->moving)) /* the wall it hit may have stopped it already */
        board_latch(board, BP_FAULT_BUMPER, true);
    board_latch_broken(board, hal->broken(hal->context));
}

static void report(struct board *board)
{
    tell_odometry(drive_of(board));
    tell_drive(drive_of(board));
}

static uint64_t next_us(const struct board *board)
{
    const struct drive *drive = (const struct drive *)board;
    return drive->moving ? (board->now_us / WATCH_US + 1) * WATCH_US : BOARD_NEVER;
}

static const struct board_device device = {&bp_drive, handle, advance, observe, report, halt, cut, next_us};

void drive_power_up(struct drive *drive, const struct drive_hal *hal, const struct board_line *line, uint32_t boot_id)
{
    drive->hal = hal;
    drive->bumpers = 0;
    drive->wanted = drive->moving = false;
    board_power_up(&drive->board, &device, line, boot_id);
}
