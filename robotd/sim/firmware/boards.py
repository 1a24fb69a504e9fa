"""Our three boards with firmware in C, each on a plant of the simulation, whose numbers become registers here."""

from typing import Any

from firmware_proto.rangefinder_messages import ShotStatus
from robotd.sim.boards.drive_board import signed16, signed32
from robotd.sim.boards.pantilt_board import PER_RAD, limits_of, tenth_mrad
from robotd.sim.firmware._native import ffi, lib
from robotd.sim.firmware.hosted import FirmwareBoard, call_back
from robotd.sim.physics.plant import DrivePlant, HeadPlant, LaserPlant, ShotAnswer

_U16_MAX = 0xFFFF
_AT_REST = 0


def drive_board(plant: DrivePlant, boot_id: int) -> FirmwareBoard:
    """Return the board of a base."""
    # C is given the address alone: handle and plant live as long as the board that keeps them.
    handle = ffi.new_handle(plant)
    names = ("advance", "command", "cut", "counts", "velocity", "bumpers", "battery_mv", "broken")
    hal = ffi.new("struct drive_hal *", _functions("drive", names, handle))
    return FirmwareBoard(ffi.new("struct drive *"), hal, lib.drive_power_up, keep=(handle, plant), boot_id=boot_id)


def pantilt_board(plant: HeadPlant, boot_id: int) -> FirmwareBoard:
    """Return the board of a head."""
    handle = ffi.new_handle(plant)
    names = ("advance", "aim", "halt", "angles", "arrives_us", "broken")
    limits = limits_of(plant)
    hal = ffi.new("struct pantilt_hal *", _functions("pantilt", names, handle))
    for name in limits.__slots__:
        setattr(hal.limits, name, getattr(limits, name))
    return FirmwareBoard(ffi.new("struct pantilt *"), hal, lib.pantilt_power_up, keep=(handle, plant), boot_id=boot_id)


def rangefinder_board(plant: LaserPlant, boot_id: int) -> FirmwareBoard:
    """Return the board of a rangefinder."""
    instrument = _Instrument(plant)
    handle = ffi.new_handle(instrument)
    hal = ffi.new("struct rangefinder_hal *", _functions("rangefinder", ("light", "shoot", "result"), handle))
    device = ffi.new("struct rangefinder *")
    return FirmwareBoard(device, hal, lib.rangefinder_power_up, keep=(handle, instrument), boot_id=boot_id)


class _Instrument:
    """A laser plant that keeps its answer until it is asked for."""

    def __init__(self, plant: LaserPlant) -> None:
        self.plant = plant
        self.answer = ShotAnswer(ShotStatus.DEVICE_ERROR, 0.0, 0, 0)


def _functions(device: str, names: tuple[str, ...], context: Any) -> dict[str, Any]:
    return {"context": context} | {name: getattr(lib, f"{device}_{name}") for name in names}


def _counts(context: Any) -> Any:
    return ffi.new("struct drive_counts *", [signed32(count) for count in ffi.from_handle(context).counts])[0]


def _velocity(context: Any) -> Any:
    return ffi.new("struct drive_velocity *", [signed16(axis * 1000) for axis in ffi.from_handle(context).velocity])[0]


def _angles(context: Any) -> Any:
    return ffi.new("struct pantilt_angles *", tenth_mrad(ffi.from_handle(context)))[0]


def _shoot(context: Any, now_us: int) -> int:
    instrument: _Instrument = ffi.from_handle(context)
    instrument.answer = instrument.plant.shoot(now_us)
    return now_us + instrument.answer.takes_us


def _result(context: Any, _now_us: int, shot: Any, _ask_us: Any) -> bool:
    answer: ShotAnswer = ffi.from_handle(context).answer
    shot.range_mm = round(answer.range_m * 1000) if answer.status is ShotStatus.OK else 0
    shot.strength = min(max(answer.strength, 0), _U16_MAX)
    shot.status = answer.status
    return True


call_back(
    "drive",
    advance=lambda context, now_us: ffi.from_handle(context).advance(now_us),
    command=lambda context, wanted: ffi.from_handle(context).command(
        wanted.speed_mmps / 1000, wanted.turn_mradps / 1000
    ),
    cut=lambda context: ffi.from_handle(context).cut(),
    counts=_counts,
    velocity=_velocity,
    bumpers=lambda context: ffi.from_handle(context).bumpers & _U16_MAX,
    battery_mv=lambda context: min(max(ffi.from_handle(context).battery_mv, 0), _U16_MAX),
    broken=lambda context: ffi.from_handle(context).broken,
)
call_back(
    "pantilt",
    advance=lambda context, now_us: ffi.from_handle(context).advance(now_us),
    aim=lambda context, to: ffi.from_handle(context).aim(to.pan_tenth_mrad / PER_RAD, to.tilt_tenth_mrad / PER_RAD),
    halt=lambda context: ffi.from_handle(context).halt(),
    angles=_angles,
    arrives_us=lambda context: ffi.from_handle(context).arrives_us or _AT_REST,
    broken=lambda context: ffi.from_handle(context).broken,
)
call_back(
    "rangefinder",
    light=lambda context, on: ffi.from_handle(context).plant.switch(on=on),
    shoot=_shoot,
    result=_result,
)
