/* Written by `python -m firmware_proto.generate` from the declarations beside this folder: edit those. */
#ifndef BP_MESSAGES_H
#define BP_MESSAGES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define BP_REPLY 128u
#define BP_REQUEST_END 64u
#define BP_TELEMETRY_START 192u
#define BP_TELEMETRY_END 240u
#define BP_PROTOCOL_MAJOR 1u
#define BP_PROTOCOL_MINOR 0u
#define BP_DICTIONARY_CHUNK 64u
#define BP_TTL_LIMIT_MS 1000u
#define BP_PAYLOAD_MAX 240u
#define BP_PACKET_MAX 256u

/* Which device a board drives; the dictionary names it. */
enum bp_board_kind {
    BP_BOARD_KIND_DRIVE = 1,
    BP_BOARD_KIND_PANTILT = 2,
    BP_BOARD_KIND_RANGEFINDER = 3
};

/* Life of a board: BOOT, Hello, IDENTIFIED, Configure, CONFIGURED, Arm, ARMED. */
enum bp_board_state {
    BP_BOARD_STATE_BOOT = 0,
    BP_BOARD_STATE_IDENTIFIED = 1,
    BP_BOARD_STATE_CONFIGURED = 2,
    BP_BOARD_STATE_ARMED = 3,
    BP_BOARD_STATE_FAULT = 4
};

/* Outcome of a request, in its reply or in a NACK. */
enum bp_result {
    BP_RESULT_OK = 0,
    BP_RESULT_UNKNOWN_TYPE = 1,
    BP_RESULT_BAD_LENGTH = 2,
    BP_RESULT_WRONG_STATE = 3,
    BP_RESULT_BAD_VALUE = 4,
    BP_RESULT_BUSY = 5
};

/* Why a board is in FAULT. */
enum bp_fault {
    BP_FAULT_NONE = 0,
    BP_FAULT_DEADMAN = 1,
    BP_FAULT_BUMPER = 2,
    BP_FAULT_BATTERY = 4,
    BP_FAULT_MOTOR = 8,
    BP_FAULT_KILLED = 16
};

/* What became of the newest Aim. */
enum bp_motion {
    BP_MOTION_DONE = 0,
    BP_MOTION_TURNING = 1,
    BP_MOTION_HALTED = 2
};

/* What became of a shot. */
enum bp_shot_status {
    BP_SHOT_STATUS_OK = 0,
    BP_SHOT_STATUS_OVER_RANGE = 1,
    BP_SHOT_STATUS_TOO_NEAR = 2,
    BP_SHOT_STATUS_WEAK = 3,
    BP_SHOT_STATUS_SATURATED = 4,
    BP_SHOT_STATUS_AMBIENT = 5,
    BP_SHOT_STATUS_NOT_MEASURED = 6,
    BP_SHOT_STATUS_LASER_OFF = 7,
    BP_SHOT_STATUS_DEVICE_ERROR = 8
};

/* Open a session; valid in every state. It disarms. */
#define BP_HELLO_TYPE 0x01u
#define BP_HELLO_SIZE 6u

struct bp_hello {
    uint8_t major; /* Protocol major version; a mismatch is refused by the host. */
    uint8_t minor; /* Protocol minor version. */
    uint32_t nonce; /* Chosen by the host, echoed, so that an old answer is not taken for this one. */
};

void bp_pack_hello(const struct bp_hello *message, uint8_t payload[BP_HELLO_SIZE]);
bool bp_unpack_hello(const uint8_t *payload, size_t size, struct bp_hello *message);

/* Identity of the board and of its boot. */
#define BP_HELLO_REPLY_TYPE 0x81u
#define BP_HELLO_REPLY_SIZE 20u

struct bp_hello_reply {
    uint8_t major; /* Protocol major version of the board. */
    uint8_t minor; /* Protocol minor version of the board. */
    uint32_t nonce; /* The host's nonce. */
    uint16_t dictionary_size; /* [bytes] Size of the compressed dictionary. */
    uint32_t dictionary_crc32; /* CRC-32 of the compressed dictionary. */
    uint32_t boot_id; /* Changes at every boot; a change voids the session. */
    uint32_t clock_hz; /* [Hz] Ticks per second of the board's clock; times are sent in microseconds. */
};

void bp_pack_hello_reply(const struct bp_hello_reply *message, uint8_t payload[BP_HELLO_REPLY_SIZE]);
bool bp_unpack_hello_reply(const uint8_t *payload, size_t size, struct bp_hello_reply *message);

/* Ask for the board's time. */
#define BP_PING_TYPE 0x02u
#define BP_PING_SIZE 8u

struct bp_ping {
    uint64_t host_us; /* [us] The host's monotonic time. */
};

void bp_pack_ping(const struct bp_ping *message, uint8_t payload[BP_PING_SIZE]);
bool bp_unpack_ping(const uint8_t *payload, size_t size, struct bp_ping *message);

/* The board's time beside the host's. */
#define BP_PONG_TYPE 0x82u
#define BP_PONG_SIZE 16u

struct bp_pong {
    uint64_t host_us; /* [us] The time in the Ping. */
    uint64_t board_us; /* [us] The board's time when the Ping arrived. */
};

void bp_pack_pong(const struct bp_pong *message, uint8_t payload[BP_PONG_SIZE]);
bool bp_unpack_pong(const uint8_t *payload, size_t size, struct bp_pong *message);

/* Read a piece of the dictionary (zlib-compressed JSON). */
#define BP_IDENTIFY_TYPE 0x03u
#define BP_IDENTIFY_SIZE 2u

struct bp_identify {
    uint16_t offset; /* [bytes] First byte wanted. */
};

void bp_pack_identify(const struct bp_identify *message, uint8_t payload[BP_IDENTIFY_SIZE]);
bool bp_unpack_identify(const uint8_t *payload, size_t size, struct bp_identify *message);

/* A piece of the dictionary, padded with zeros after its end. */
#define BP_IDENTIFY_REPLY_TYPE 0x83u
#define BP_IDENTIFY_REPLY_SIZE 66u

struct bp_identify_reply {
    uint16_t offset; /* [bytes] First byte given. */
    uint8_t data[64]; /* [bytes] The bytes. */
};

void bp_pack_identify_reply(const struct bp_identify_reply *message, uint8_t payload[BP_IDENTIFY_REPLY_SIZE]);
bool bp_unpack_identify_reply(const uint8_t *payload, size_t size, struct bp_identify_reply *message);

/* Set what the session needs; leads to CONFIGURED, disarmed. */
#define BP_CONFIGURE_TYPE 0x04u
#define BP_CONFIGURE_SIZE 4u

struct bp_configure {
    uint16_t telemetry_ms; /* [ms] Period of the periodic telemetry. */
    uint16_t ttl_max_ms; /* [ms] Longest ttl_ms that the board grants; longer ones are capped to it. */
};

void bp_pack_configure(const struct bp_configure *message, uint8_t payload[BP_CONFIGURE_SIZE]);
bool bp_unpack_configure(const uint8_t *payload, size_t size, struct bp_configure *message);

/* What the board took over. */
#define BP_CONFIGURE_REPLY_TYPE 0x84u
#define BP_CONFIGURE_REPLY_SIZE 5u

struct bp_configure_reply {
    uint8_t result; /* [Result] OK, or why not. */
    uint32_t config_crc32; /* CRC-32 of the Configure payload taken over. */
};

void bp_pack_configure_reply(const struct bp_configure_reply *message, uint8_t payload[BP_CONFIGURE_REPLY_SIZE]);
bool bp_unpack_configure_reply(const uint8_t *payload, size_t size, struct bp_configure_reply *message);

/* Allow motion; valid in CONFIGURED and ARMED. */
#define BP_ARM_TYPE 0x05u
#define BP_ARM_SIZE 0u

/* Stop and forbid motion: ARMED goes back to CONFIGURED. */
#define BP_DISARM_TYPE 0x06u
#define BP_DISARM_SIZE 0u

/* Acknowledge a latched fault: FAULT goes to CONFIGURED. */
#define BP_CLEAR_TYPE 0x07u
#define BP_CLEAR_SIZE 0u

/* Ramp down and disarm. Accepted in every state, whatever the session. */
#define BP_STOP_TYPE 0x11u
#define BP_STOP_SIZE 0u

/* Cut the motors at once and latch KILLED. Accepted in every state, whatever the session. */
#define BP_KILL_TYPE 0x12u
#define BP_KILL_SIZE 0u

/* Periodic and on every change: state, fault, and what the board's receiver counted. */
#define BP_BOARD_STATUS_TYPE 0xC0u
#define BP_BOARD_STATUS_SIZE 17u

struct bp_board_status {
    uint64_t board_us; /* [us] The board's time. */
    uint8_t state; /* [BoardState] Where in its life the board is. */
    uint16_t faults; /* [Fault] Latched faults. */
    uint16_t crc_errors; /* Packets refused by CRC, modulo 65536. */
    uint16_t cobs_errors; /* Packets refused by COBS, modulo 65536. */
    uint16_t length_errors; /* Packets or payloads of a wrong length, modulo 65536. */
};

void bp_pack_board_status(const struct bp_board_status *message, uint8_t payload[BP_BOARD_STATUS_SIZE]);
bool bp_unpack_board_status(const uint8_t *payload, size_t size, struct bp_board_status *message);

/* Reply to every request that has no reply of its own; its type is the request's | 0x80. */
#define BP_ACK_TYPE 0x80u
#define BP_ACK_SIZE 1u

struct bp_ack {
    uint8_t result; /* [Result] OK, or why not. */
};

void bp_pack_ack(const struct bp_ack *message, uint8_t payload[BP_ACK_SIZE]);
bool bp_unpack_ack(const uint8_t *payload, size_t size, struct bp_ack *message);

/* The request was not understood or not allowed; same seq as the request. */
#define BP_NACK_TYPE 0xFEu
#define BP_NACK_SIZE 2u

struct bp_nack {
    uint8_t code; /* [Result] Why. */
    uint8_t of_type; /* Type of the refused frame. */
};

void bp_pack_nack(const struct bp_nack *message, uint8_t payload[BP_NACK_SIZE]);
bool bp_unpack_nack(const uint8_t *payload, size_t size, struct bp_nack *message);

/* Velocity set-point; the newest wins and lives for ttl_ms. Only in ARMED. */
#define BP_SET_VELOCITY_TYPE 0x10u
#define BP_SET_VELOCITY_SIZE 6u

struct bp_set_velocity {
    int16_t speed_mmps; /* [mm/s] Translation along the heading. */
    int16_t turn_mradps; /* [mrad/s] Rotation of the heading, counter-clockwise. */
    uint16_t ttl_ms; /* [ms] Without a newer set-point by then, a moving base ramps down and latches DEADMAN. */
};

void bp_pack_set_velocity(const struct bp_set_velocity *message, uint8_t payload[BP_SET_VELOCITY_SIZE]);
bool bp_unpack_set_velocity(const uint8_t *payload, size_t size, struct bp_set_velocity *message);

/* Periodic: what the two encoders counted. Cumulative, so a lost report loses nothing. */
#define BP_ODOMETRY_REPORT_TYPE 0xC1u
#define BP_ODOMETRY_REPORT_SIZE 20u

struct bp_odometry_report {
    uint64_t board_us; /* [us] When it was measured, the board's time. */
    int32_t translate_counts; /* [counts] Translation encoder, wraps. */
    int32_t rotate_counts; /* [counts] Rotation encoder, counter-clockwise, wraps. */
    int16_t speed_mmps; /* [mm/s] Measured translation. */
    int16_t turn_mradps; /* [mrad/s] Measured rotation. */
};

void bp_pack_odometry_report(const struct bp_odometry_report *message, uint8_t payload[BP_ODOMETRY_REPORT_SIZE]);
bool bp_unpack_odometry_report(const uint8_t *payload, size_t size, struct bp_odometry_report *message);

/* Periodic and on every change: battery and bumpers. */
#define BP_DRIVE_REPORT_TYPE 0xC2u
#define BP_DRIVE_REPORT_SIZE 12u

struct bp_drive_report {
    uint64_t board_us; /* [us] The board's time. */
    uint16_t battery_mv; /* [mV] Battery voltage. */
    uint16_t bumpers; /* [bit set] Pressed bumpers; bit i is centred at i * 22.5 degrees counter-clockwise of the heading. */
};

void bp_pack_drive_report(const struct bp_drive_report *message, uint8_t payload[BP_DRIVE_REPORT_SIZE]);
bool bp_unpack_drive_report(const uint8_t *payload, size_t size, struct bp_drive_report *message);

/* Turn the head; the newest wins and must be done within ttl_ms. Only in ARMED. */
#define BP_AIM_TYPE 0x20u
#define BP_AIM_SIZE 10u

struct bp_aim {
    int32_t pan_tenth_mrad; /* [0.1 mrad] Pan, counter-clockwise from straight ahead. */
    int32_t tilt_tenth_mrad; /* [0.1 mrad] Tilt, up from level. */
    uint16_t ttl_ms; /* [ms] A head still turning by then halts and latches DEADMAN. */
};

void bp_pack_aim(const struct bp_aim *message, uint8_t payload[BP_AIM_SIZE]);
bool bp_unpack_aim(const uint8_t *payload, size_t size, struct bp_aim *message);

/* Ask where the head points. */
#define BP_READ_AIM_TYPE 0x21u
#define BP_READ_AIM_SIZE 0u

/* Where the head points. */
#define BP_AIM_READBACK_TYPE 0xA1u
#define BP_AIM_READBACK_SIZE 19u

struct bp_aim_readback {
    uint64_t board_us; /* [us] The board's time. */
    int32_t pan_tenth_mrad; /* [0.1 mrad] Measured pan. */
    int32_t tilt_tenth_mrad; /* [0.1 mrad] Measured tilt. */
    uint16_t aim_seq; /* seq of the newest Aim. */
    uint8_t moving; /* [Motion] Whether it is there, turns, or was halted. */
};

void bp_pack_aim_readback(const struct bp_aim_readback *message, uint8_t payload[BP_AIM_READBACK_SIZE]);
bool bp_unpack_aim_readback(const uint8_t *payload, size_t size, struct bp_aim_readback *message);

/* Ask for the mechanical limits. */
#define BP_READ_LIMITS_TYPE 0x22u
#define BP_READ_LIMITS_SIZE 0u

/* The mechanical limits; a pan range of a full turn or more is endless. */
#define BP_LIMITS_TYPE 0xA2u
#define BP_LIMITS_SIZE 16u

struct bp_limits {
    int32_t pan_min_tenth_mrad; /* [0.1 mrad] Lowest pan. */
    int32_t pan_max_tenth_mrad; /* [0.1 mrad] Highest pan. */
    int32_t tilt_min_tenth_mrad; /* [0.1 mrad] Lowest tilt. */
    int32_t tilt_max_tenth_mrad; /* [0.1 mrad] Highest tilt. */
};

void bp_pack_limits(const struct bp_limits *message, uint8_t payload[BP_LIMITS_SIZE]);
bool bp_unpack_limits(const uint8_t *payload, size_t size, struct bp_limits *message);

/* Periodic, and at once when a motion is done: where the head points. */
#define BP_AIM_REPORT_TYPE 0xC4u
#define BP_AIM_REPORT_SIZE 19u

struct bp_aim_report {
    uint64_t board_us; /* [us] The board's time. */
    int32_t pan_tenth_mrad; /* [0.1 mrad] Measured pan. */
    int32_t tilt_tenth_mrad; /* [0.1 mrad] Measured tilt. */
    uint16_t aim_seq; /* seq of the newest Aim. */
    uint8_t moving; /* [Motion] DONE with the aim_seq of an Aim is *motion done*. */
};

void bp_pack_aim_report(const struct bp_aim_report *message, uint8_t payload[BP_AIM_REPORT_SIZE]);
bool bp_unpack_aim_report(const uint8_t *payload, size_t size, struct bp_aim_report *message);

/* Switch the laser. Only in CONFIGURED and ARMED; Stop and Disarm switch it off. */
#define BP_SET_LASER_TYPE 0x30u
#define BP_SET_LASER_SIZE 1u

struct bp_set_laser {
    uint8_t on; /* [bool] 1 on, 0 off. */
};

void bp_pack_set_laser(const struct bp_set_laser *message, uint8_t payload[BP_SET_LASER_SIZE]);
bool bp_unpack_set_laser(const uint8_t *payload, size_t size, struct bp_set_laser *message);

/* Take one reading and answer with it. */
#define BP_SHOOT_TYPE 0x31u
#define BP_SHOOT_SIZE 2u

struct bp_shoot {
    uint16_t timeout_ms; /* [ms] Longest time the measurement may take. */
};

void bp_pack_shoot(const struct bp_shoot *message, uint8_t payload[BP_SHOOT_SIZE]);
bool bp_unpack_shoot(const uint8_t *payload, size_t size, struct bp_shoot *message);

/* One reading along the beam. */
#define BP_SHOT_TYPE 0xB1u
#define BP_SHOT_SIZE 15u

struct bp_shot {
    uint64_t board_us; /* [us] When the light was sent, the board's time. */
    uint32_t range_mm; /* [mm] Distance along the beam; 0 unless the status is OK. */
    uint16_t strength; /* Signal strength, as the instrument counts it. */
    uint8_t status; /* [ShotStatus] What became of the shot. */
};

void bp_pack_shot(const struct bp_shot *message, uint8_t payload[BP_SHOT_SIZE]);
bool bp_unpack_shot(const uint8_t *payload, size_t size, struct bp_shot *message);

#endif
