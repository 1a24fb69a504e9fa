"""How the firmware is compiled for this machine: cffi in API mode, limited ABI. Read by setup.py, never imported."""

from cffi import FFI

SOURCES = ("board", "checksum", "devices", "drive", "frame", "messages", "outbox", "pantilt", "rangefinder")
PLACE = "firmware_proto/c"

builder = FFI()
builder.cdef("""
    struct board_line { void *context; void (*write)(void *, const uint8_t *, size_t); };
    struct board { uint16_t faults; ...; };
    void board_receive(struct board *, const uint8_t *, size_t, uint64_t now_us);
    void board_advance(struct board *, uint64_t now_us);
    uint64_t board_next_us(const struct board *);
    uint8_t board_state(const struct board *);
    extern "Python" void line_write(void *, const uint8_t *, size_t);

    struct drive_velocity { int16_t speed_mmps, turn_mradps; };
    struct drive_counts { int32_t translate, rotate; };
    struct drive_hal {
        void *context;
        void (*advance)(void *, uint64_t);
        void (*command)(void *, struct drive_velocity);
        void (*cut)(void *);
        struct drive_counts (*counts)(void *);
        struct drive_velocity (*velocity)(void *);
        uint16_t (*bumpers)(void *);
        uint16_t (*battery_mv)(void *);
        uint16_t (*broken)(void *);
    };
    struct drive { struct board board; ...; };
    void drive_power_up(struct drive *, const struct drive_hal *, const struct board_line *, uint32_t boot_id);
    extern "Python" void drive_advance(void *, uint64_t);
    extern "Python" void drive_command(void *, struct drive_velocity);
    extern "Python" void drive_cut(void *);
    extern "Python" struct drive_counts drive_counts(void *);
    extern "Python" struct drive_velocity drive_velocity(void *);
    extern "Python" uint16_t drive_bumpers(void *);
    extern "Python" uint16_t drive_battery_mv(void *);
    extern "Python" uint16_t drive_broken(void *);

    struct bp_limits { int32_t pan_min_tenth_mrad, pan_max_tenth_mrad, tilt_min_tenth_mrad, tilt_max_tenth_mrad; };
    struct pantilt_angles { int32_t pan_tenth_mrad, tilt_tenth_mrad; };
    struct pantilt_hal {
        void *context;
        struct bp_limits limits;
        void (*advance)(void *, uint64_t);
        void (*aim)(void *, struct pantilt_angles);
        void (*halt)(void *);
        struct pantilt_angles (*angles)(void *);
        uint64_t (*arrives_us)(void *);
        uint16_t (*broken)(void *);
    };
    struct pantilt { struct board board; ...; };
    void pantilt_power_up(struct pantilt *, const struct pantilt_hal *, const struct board_line *, uint32_t boot_id);
    extern "Python" void pantilt_advance(void *, uint64_t);
    extern "Python" void pantilt_aim(void *, struct pantilt_angles);
    extern "Python" void pantilt_halt(void *);
    extern "Python" struct pantilt_angles pantilt_angles(void *);
    extern "Python" uint64_t pantilt_arrives_us(void *);
    extern "Python" uint16_t pantilt_broken(void *);

    struct rangefinder_shot { uint32_t range_mm; uint16_t strength; uint8_t status; };
    struct rangefinder_hal {
        void *context;
        void (*light)(void *, bool);
        uint64_t (*shoot)(void *, uint64_t);
        bool (*result)(void *, uint64_t, struct rangefinder_shot *, uint64_t *);
    };
    struct rangefinder { struct board board; ...; };
    void rangefinder_power_up(struct rangefinder *, const struct rangefinder_hal *, const struct board_line *,
                              uint32_t boot_id);
    extern "Python" void rangefinder_light(void *, bool);
    extern "Python" uint64_t rangefinder_shoot(void *, uint64_t);
    extern "Python" bool rangefinder_result(void *, uint64_t, struct rangefinder_shot *, uint64_t *);
""")
builder.set_source(
    "robotd.sim.firmware._native",
    '#include "drive.h"\n#include "pantilt.h"\n#include "rangefinder.h"\n',
    sources=[f"{PLACE}/{name}.c" for name in SOURCES],
    include_dirs=[PLACE],
    extra_compile_args=["-std=c99", "-O2", "-fvisibility=hidden", "-Wall", "-Wextra"],
    py_limited_api=True,  # one build for every version of Python
)
