/* A board on a plant that does what a script says; tells whatever the board does. See peer.py.
 *
 * Read: "P number..." sets what the plant measures, "R time hex" is heard, "A time" passes, "B boot_id" is a reboot.
 * Told: "! ..." what the plant is made to do, "> hex" what is sent, "= next state faults" after each line but P. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "drive.h"
#include "pantilt.h"
#include "rangefinder.h"

#define LINE_MAX_BYTES 16384
#define NUMBERS 8

static int64_t plant[NUMBERS]; /* what the numbers mean, the functions of each device say */
#define TROUBLE plant[7]       /* what Python's plants cannot do: break, or not know when a measurement is done */
static uint64_t plant_now_us;
static uint64_t arrives_us;

static void drive_advance(void *context, uint64_t now_us)
{
    (void)context;
    printf("! advance %" PRIu64 "\n", now_us);
    plant_now_us = now_us;
    if (arrives_us <= now_us)
        arrives_us = PANTILT_AT_REST;
}

static void drive_command(void *context, struct drive_velocity wanted)
{
    (void)context;
    printf("! command %d %d\n", wanted.speed_mmps, wanted.turn_mradps);
}

static void drive_cut(void *context)
{
    (void)context;
    printf("! cut\n");
}

static struct drive_counts drive_counts(void *context)
{
    const struct drive_counts counts = {(int32_t)plant[0], (int32_t)plant[1]};
    (void)context;
    return counts;
}

static struct drive_velocity drive_velocity(void *context)
{
    const struct drive_velocity velocity = {(int16_t)plant[2], (int16_t)plant[3]};
    (void)context;
    return velocity;
}

static uint16_t drive_bumpers(void *context)
{
    (void)context;
    return (uint16_t)plant[4];
}

static uint16_t drive_battery_mv(void *context)
{
    (void)context;
    return (uint16_t)plant[5];
}

static uint16_t broken(void *context)
{
    (void)context;
    return (uint16_t)TROUBLE;
}

static void pantilt_aim(void *context, struct pantilt_angles to)
{
    (void)context;
    printf("! aim %" PRId32 " %" PRId32 "\n", to.pan_tenth_mrad, to.tilt_tenth_mrad);
    arrives_us = plant_now_us + (uint64_t)plant[2];
}

static void pantilt_halt(void *context)
{
    (void)context;
    printf("! halt\n");
    arrives_us = PANTILT_AT_REST;
}

static struct pantilt_angles pantilt_angles(void *context)
{
    const struct pantilt_angles angles = {(int32_t)plant[0], (int32_t)plant[1]};
    (void)context;
    return angles;
}

static uint64_t pantilt_arrives_us(void *context)
{
    (void)context;
    return arrives_us;
}

static struct rangefinder_shot shot;
static uint64_t shot_done_us;

static void rangefinder_light(void *context, bool on)
{
    (void)context;
    printf("! light %d\n", on);
}

static uint64_t rangefinder_shoot(void *context, uint64_t now_us)
{
    (void)context;
    printf("! shoot %" PRIu64 "\n", now_us);
    shot.range_mm = (uint32_t)plant[0];
    shot.strength = (uint16_t)plant[1];
    shot.status = (uint8_t)plant[2];
    shot_done_us = now_us + (uint64_t)plant[3];
    return TROUBLE != 0 ? now_us + (uint64_t)TROUBLE : shot_done_us;
}

static bool rangefinder_result(void *context, uint64_t now_us, struct rangefinder_shot *result, uint64_t *ask_us)
{
    (void)context;
    *ask_us = now_us + (uint64_t)TROUBLE < shot_done_us ? now_us + (uint64_t)TROUBLE : shot_done_us;
    *result = shot;
    return now_us >= shot_done_us;
}

static void line_write(void *context, const uint8_t *bytes, size_t size)
{
    (void)context;
    printf("> ");
    for (size_t i = 0; i < size; i++)
        printf("%02x", bytes[i]);
    putchar('\n');
}

static const struct board_line line = {NULL, line_write};
static const struct drive_hal drive_hal = {NULL,           drive_advance, drive_command,    drive_cut,     drive_counts,
                                           drive_velocity, drive_bumpers, drive_battery_mv, broken};
static const struct pantilt_hal pantilt_hal = {
    NULL,         {-27000, 27000, -8000, 5000}, drive_advance, pantilt_aim, pantilt_halt, pantilt_angles,
    pantilt_arrives_us, broken};
static const struct rangefinder_hal rangefinder_hal = {NULL, rangefinder_light, rangefinder_shoot, rangefinder_result};

static struct drive drive;
static struct pantilt pantilt;
static struct rangefinder rangefinder;

static struct board *power_up(const char *kind, uint32_t boot_id)
{
    if (strcmp(kind, "drive") == 0) {
        drive_power_up(&drive, &drive_hal, &line, boot_id);
        return &drive.board;
    }
    if (strcmp(kind, "pantilt") == 0) {
        pantilt_power_up(&pantilt, &pantilt_hal, &line, boot_id);
        return &pantilt.board;
    }
    rangefinder_power_up(&rangefinder, &rangefinder_hal, &line, boot_id);
    return &rangefinder.board;
}

static size_t from_hex(const char *text, uint8_t *bytes)
{
    unsigned byte = 0;
    size_t size = 0;
    while (sscanf(text + 2 * size, "%2x", &byte) == 1)
        bytes[size++] = (uint8_t)byte;
    return size;
}

static void set_plant(const char *text)
{
    int used = 0;
    for (size_t i = 0; i < NUMBERS && sscanf(text, "%" SCNd64 "%n", &plant[i], &used) == 1; i++)
        text += used;
}

int main(int count, char **words)
{
    static char text[LINE_MAX_BYTES];
    static uint8_t heard[LINE_MAX_BYTES / 2];
    const char *kind = count > 1 ? words[1] : "drive";
    struct board *board = power_up(kind, 7);
    while (fgets(text, sizeof text, stdin) != NULL) {
        uint64_t number = 0;
        int used = 0;
        if (text[0] == 'P') {
            set_plant(text + 1);
            continue;
        }
        (void)sscanf(text + 1, "%" SCNu64 "%n", &number, &used);
        if (text[0] == 'B')
            board = power_up(kind, (uint32_t)number);
        else if (text[0] == 'A')
            board_advance(board, number);
        else
            board_receive(board, heard, from_hex(text + used + 2, heard), number);
        printf("= %" PRIu64 " %u %u\n", board_next_us(board), board_state(board), board->faults);
    }
    return 0;
}
