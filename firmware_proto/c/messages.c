/* Written by `python -m firmware_proto.generate` from the declarations beside this folder: edit those. */
#include "messages.h"

#include "little_endian.h"

void bp_pack_hello(const struct bp_hello *message, uint8_t payload[BP_HELLO_SIZE])
{
    bp_put_u8(payload, message->major);
    bp_put_u8(payload + 1, message->minor);
    bp_put_u32(payload + 2, message->nonce);
}

bool bp_unpack_hello(const uint8_t *payload, size_t size, struct bp_hello *message)
{
    if (size != BP_HELLO_SIZE)
        return false;
    message->major = bp_get_u8(payload);
    message->minor = bp_get_u8(payload + 1);
    message->nonce = bp_get_u32(payload + 2);
    return true;
}

void bp_pack_hello_reply(const struct bp_hello_reply *message, uint8_t payload[BP_HELLO_REPLY_SIZE])
{
    bp_put_u8(payload, message->major);
    bp_put_u8(payload + 1, message->minor);
    bp_put_u32(payload + 2, message->nonce);
    bp_put_u16(payload + 6, message->dictionary_size);
    bp_put_u32(payload + 8, message->dictionary_crc32);
    bp_put_u32(payload + 12, message->boot_id);
    bp_put_u32(payload + 16, message->clock_hz);
}

bool bp_unpack_hello_reply(const uint8_t *payload, size_t size, struct bp_hello_reply *message)
{
    if (size != BP_HELLO_REPLY_SIZE)
        return false;
    message->major = bp_get_u8(payload);
    message->minor = bp_get_u8(payload + 1);
    message->nonce = bp_get_u32(payload + 2);
    message->dictionary_size = bp_get_u16(payload + 6);
    message->dictionary_crc32 = bp_get_u32(payload + 8);
    message->boot_id = bp_get_u32(payload + 12);
    message->clock_hz = bp_get_u32(payload + 16);
    return true;
}

void bp_pack_ping(const struct bp_ping *message, uint8_t payload[BP_PING_SIZE])
{
    bp_put_u64(payload, message->host_us);
}

bool bp_unpack_ping(const uint8_t *payload, size_t size, struct bp_ping *message)
{
    if (size != BP_PING_SIZE)
        return false;
    message->host_us = bp_get_u64(payload);
    return true;
}

void bp_pack_pong(const struct bp_pong *message, uint8_t payload[BP_PONG_SIZE])
{
    bp_put_u64(payload, message->host_us);
    bp_put_u64(payload + 8, message->board_us);
}

bool bp_unpack_pong(const uint8_t *payload, size_t size, struct bp_pong *message)
{
    if (size != BP_PONG_SIZE)
        return false;
    message->host_us = bp_get_u64(payload);
    message->board_us = bp_get_u64(payload + 8);
    return true;
}

void bp_pack_identify(const struct bp_identify *message, uint8_t payload[BP_IDENTIFY_SIZE])
{
    bp_put_u16(payload, message->offset);
}

bool bp_unpack_identify(const uint8_t *payload, size_t size, struct bp_identify *message)
{
    if (size != BP_IDENTIFY_SIZE)
        return false;
    message->offset = bp_get_u16(payload);
    return true;
}

void bp_pack_identify_reply(const struct bp_identify_reply *message, uint8_t payload[BP_IDENTIFY_REPLY_SIZE])
{
    bp_put_u16(payload, message->offset);
    bp_copy(payload + 2, message->data, 64);
}

bool bp_unpack_identify_reply(const uint8_t *payload, size_t size, struct bp_identify_reply *message)
{
    if (size != BP_IDENTIFY_REPLY_SIZE)
        return false;
    message->offset = bp_get_u16(payload);
    bp_copy(message->data, payload + 2, 64);
    return true;
}

void bp_pack_configure(const struct bp_configure *message, uint8_t payload[BP_CONFIGURE_SIZE])
{
    bp_put_u16(payload, message->telemetry_ms);
    bp_put_u16(payload + 2, message->ttl_max_ms);
}

bool bp_unpack_configure(const uint8_t *payload, size_t size, struct bp_configure *message)
{
    if (size != BP_CONFIGURE_SIZE)
        return false;
    message->telemetry_ms = bp_get_u16(payload);
    message->ttl_max_ms = bp_get_u16(payload + 2);
    return true;
}

void bp_pack_configure_reply(const struct bp_configure_reply *message, uint8_t payload[BP_CONFIGURE_REPLY_SIZE])
{
    bp_put_u8(payload, message->result);
    bp_put_u32(payload + 1, message->config_crc32);
}

bool bp_unpack_configure_reply(const uint8_t *payload, size_t size, struct bp_configure_reply *message)
{
    if (size != BP_CONFIGURE_REPLY_SIZE)
        return false;
    message->result = bp_get_u8(payload);
    message->config_crc32 = bp_get_u32(payload + 1);
    return true;
}

void bp_pack_board_status(const struct bp_board_status *message, uint8_t payload[BP_BOARD_STATUS_SIZE])
{
    bp_put_u64(payload, message->board_us);
    bp_put_u8(payload + 8, message->state);
    bp_put_u16(payload + 9, message->faults);
    bp_put_u16(payload + 11, message->crc_errors);
    bp_put_u16(payload + 13, message->cobs_errors);
    bp_put_u16(payload + 15, message->length_errors);
}

bool bp_unpack_board_status(const uint8_t *payload, size_t size, struct bp_board_status *message)
{
    if (size != BP_BOARD_STATUS_SIZE)
        return false;
    message->board_us = bp_get_u64(payload);
    message->state = bp_get_u8(payload + 8);
    message->faults = bp_get_u16(payload + 9);
    message->crc_errors = bp_get_u16(payload + 11);
    message->cobs_errors = bp_get_u16(payload + 13);
    message->length_errors = bp_get_u16(payload + 15);
    return true;
}

void bp_pack_ack(const struct bp_ack *message, uint8_t payload[BP_ACK_SIZE])
{
    bp_put_u8(payload, message->result);
}

bool bp_unpack_ack(const uint8_t *payload, size_t size, struct bp_ack *message)
{
    if (size != BP_ACK_SIZE)
        return false;
    message->result = bp_get_u8(payload);
    return true;
}

void bp_pack_nack(const struct bp_nack *message, uint8_t payload[BP_NACK_SIZE])
{
    bp_put_u8(payload, message->code);
    bp_put_u8(payload + 1, message->of_type);
}

bool bp_unpack_nack(const uint8_t *payload, size_t size, struct bp_nack *message)
{
    if (size != BP_NACK_SIZE)
        return false;
    message->code = bp_get_u8(payload);
    message->of_type = bp_get_u8(payload + 1);
    return true;
}

void bp_pack_set_velocity(const struct bp_set_velocity *message, uint8_t payload[BP_SET_VELOCITY_SIZE])
{
    bp_put_u16(payload, (uint16_t)message->speed_mmps);
    bp_put_u16(payload + 2, (uint16_t)message->turn_mradps);
    bp_put_u16(payload + 4, message->ttl_ms);
}

bool bp_unpack_set_velocity(const uint8_t *payload, size_t size, struct bp_set_velocity *message)
{
    if (size != BP_SET_VELOCITY_SIZE)
        return false;
    message->speed_mmps = bp_get_i16(payload);
    message->turn_mradps = bp_get_i16(payload + 2);
    message->ttl_ms = bp_get_u16(payload + 4);
    return true;
}

void bp_pack_odometry_report(const struct bp_odometry_report *message, uint8_t payload[BP_ODOMETRY_REPORT_SIZE])
{
    bp_put_u64(payload, message->board_us);
    bp_put_u32(payload + 8, (uint32_t)message->translate_counts);
    bp_put_u32(payload + 12, (uint32_t)message->rotate_counts);
    bp_put_u16(payload + 16, (uint16_t)message->speed_mmps);
    bp_put_u16(payload + 18, (uint16_t)message->turn_mradps);
}

bool bp_unpack_odometry_report(const uint8_t *payload, size_t size, struct bp_odometry_report *message)
{
    if (size != BP_ODOMETRY_REPORT_SIZE)
        return false;
    message->board_us = bp_get_u64(payload);
    message->translate_counts = bp_get_i32(payload + 8);
    message->rotate_counts = bp_get_i32(payload + 12);
    message->speed_mmps = bp_get_i16(payload + 16);
    message->turn_mradps = bp_get_i16(payload + 18);
    return true;
}

void bp_pack_drive_report(const struct bp_drive_report *message, uint8_t payload[BP_DRIVE_REPORT_SIZE])
{
    bp_put_u64(payload, message->board_us);
    bp_put_u16(payload + 8, message->battery_mv);
    bp_put_u16(payload + 10, message->bumpers);
}

bool bp_unpack_drive_report(const uint8_t *payload, size_t size, struct bp_drive_report *message)
{
    if (size != BP_DRIVE_REPORT_SIZE)
        return false;
    message->board_us = bp_get_u64(payload);
    message->battery_mv = bp_get_u16(payload + 8);
    message->bumpers = bp_get_u16(payload + 10);
    return true;
}

void bp_pack_aim(const struct bp_aim *message, uint8_t payload[BP_AIM_SIZE])
{
    bp_put_u32(payload, (uint32_t)message->pan_tenth_mrad);
    bp_put_u32(payload + 4, (uint32_t)message->tilt_tenth_mrad);
    bp_put_u16(payload + 8, message->ttl_ms);
}

bool bp_unpack_aim(const uint8_t *payload, size_t size, struct bp_aim *message)
{
    if (size != BP_AIM_SIZE)
        return false;
    message->pan_tenth_mrad = bp_get_i32(payload);
    message->tilt_tenth_mrad = bp_get_i32(payload + 4);
    message->ttl_ms = bp_get_u16(payload + 8);
    return true;
}

void bp_pack_aim_readback(const struct bp_aim_readback *message, uint8_t payload[BP_AIM_READBACK_SIZE])
{
    bp_put_u64(payload, message->board_us);
    bp_put_u32(payload + 8, (uint32_t)message->pan_tenth_mrad);
    bp_put_u32(payload + 12, (uint32_t)message->tilt_tenth_mrad);
    bp_put_u16(payload + 16, message->aim_seq);
    bp_put_u8(payload + 18, message->moving);
}

bool bp_unpack_aim_readback(const uint8_t *payload, size_t size, struct bp_aim_readback *message)
{
    if (size != BP_AIM_READBACK_SIZE)
        return false;
    message->board_us = bp_get_u64(payload);
    message->pan_tenth_mrad = bp_get_i32(payload + 8);
    message->tilt_tenth_mrad = bp_get_i32(payload + 12);
    message->aim_seq = bp_get_u16(payload + 16);
    message->moving = bp_get_u8(payload + 18);
    return true;
}

void bp_pack_limits(const struct bp_limits *message, uint8_t payload[BP_LIMITS_SIZE])
{
    bp_put_u32(payload, (uint32_t)message->pan_min_tenth_mrad);
    bp_put_u32(payload + 4, (uint32_t)message->pan_max_tenth_mrad);
    bp_put_u32(payload + 8, (uint32_t)message->tilt_min_tenth_mrad);
    bp_put_u32(payload + 12, (uint32_t)message->tilt_max_tenth_mrad);
}

bool bp_unpack_limits(const uint8_t *payload, size_t size, struct bp_limits *message)
{
    if (size != BP_LIMITS_SIZE)
        return false;
    message->pan_min_tenth_mrad = bp_get_i32(payload);
    message->pan_max_tenth_mrad = bp_get_i32(payload + 4);
    message->tilt_min_tenth_mrad = bp_get_i32(payload + 8);
    message->tilt_max_tenth_mrad = bp_get_i32(payload + 12);
    return true;
}

void bp_pack_aim_report(const struct bp_aim_report *message, uint8_t payload[BP_AIM_REPORT_SIZE])
{
    bp_put_u64(payload, message->board_us);
    bp_put_u32(payload + 8, (uint32_t)message->pan_tenth_mrad);
    bp_put_u32(payload + 12, (uint32_t)message->tilt_tenth_mrad);
    bp_put_u16(payload + 16, message->aim_seq);
    bp_put_u8(payload + 18, message->moving);
}

bool bp_unpack_aim_report(const uint8_t *payload, size_t size, struct bp_aim_report *message)
{
    if (size != BP_AIM_REPORT_SIZE)
        return false;
    message->board_us = bp_get_u64(payload);
    message->pan_tenth_mrad = bp_get_i32(payload + 8);
    message->tilt_tenth_mrad = bp_get_i32(payload + 12);
    message->aim_seq = bp_get_u16(payload + 16);
    message->moving = bp_get_u8(payload + 18);
    return true;
}

void bp_pack_set_laser(const struct bp_set_laser *message, uint8_t payload[BP_SET_LASER_SIZE])
{
    bp_put_u8(payload, message->on);
}

bool bp_unpack_set_laser(const uint8_t *payload, size_t size, struct bp_set_laser *message)
{
    if (size != BP_SET_LASER_SIZE)
        return false;
    message->on = bp_get_u8(payload);
    return true;
}

void bp_pack_shoot(const struct bp_shoot *message, uint8_t payload[BP_SHOOT_SIZE])
{
    bp_put_u16(payload, message->timeout_ms);
}

bool bp_unpack_shoot(const uint8_t *payload, size_t size, struct bp_shoot *message)
{
    if (size != BP_SHOOT_SIZE)
        return false;
    message->timeout_ms = bp_get_u16(payload);
    return true;
}

void bp_pack_shot(const struct bp_shot *message, uint8_t payload[BP_SHOT_SIZE])
{
    bp_put_u64(payload, message->board_us);
    bp_put_u32(payload + 8, message->range_mm);
    bp_put_u16(payload + 12, message->strength);
    bp_put_u8(payload + 14, message->status);
}

bool bp_unpack_shot(const uint8_t *payload, size_t size, struct bp_shot *message)
{
    if (size != BP_SHOT_SIZE)
        return false;
    message->board_us = bp_get_u64(payload);
    message->range_mm = bp_get_u32(payload + 8);
    message->strength = bp_get_u16(payload + 12);
    message->status = bp_get_u8(payload + 14);
    return true;
}
