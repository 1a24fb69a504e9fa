"""The emulated board of the pan/tilt head."""

import math
from collections.abc import Iterator

from firmware_proto.common import BoardKind, Result
from firmware_proto.pantilt_messages import Aim, AimReadback, AimReport, Limits, Motion, ReadAim, ReadLimits
from firmware_proto.schema import Message
from robotd.sim.boards.emulated_board import Board, Handler, Outcome
from robotd.sim.physics.plant import HeadPlant

PER_RAD = 10_000
"""Counts of an angle on the wire."""


class PanTiltBoard(Board):
    """Turns a :class:`HeadPlant` as PROTOCOL.md says."""

    def __init__(self, plant: HeadPlant, *, boot_id: int) -> None:
        self._plant = plant
        self._limits = limits_of(plant)
        self._motion = Motion.HALTED
        self._aim_seq = 0
        handlers: dict[type[Message], Handler] = {
            Aim: self._aim,
            ReadAim: self._read_aim,
            ReadLimits: self._read_limits,
        }
        super().__init__(BoardKind.PANTILT, handlers, boot_id=boot_id)

    def _aim(self, aim: Aim, seq: int) -> Outcome:
        if not aim.ttl_ms or not self._reaches(aim):
            return Result.BAD_VALUE
        self._plant.aim(aim.pan_tenth_mrad / PER_RAD, aim.tilt_tenth_mrad / PER_RAD)
        self._motion = Motion.TURNING
        self._aim_seq = seq
        self._grant(aim.ttl_ms)
        return Result.OK

    def _reaches(self, aim: Aim) -> bool:
        limits = self._limits
        return (
            limits.pan_min_tenth_mrad <= aim.pan_tenth_mrad <= limits.pan_max_tenth_mrad
            and limits.tilt_min_tenth_mrad <= aim.tilt_tenth_mrad <= limits.tilt_max_tenth_mrad
        )

    def _read_aim(self, read: ReadAim, seq: int) -> Outcome:
        return AimReadback(self._now_us, *tenth_mrad(self._plant), self._aim_seq, self._motion)

    def _read_limits(self, read: ReadLimits, seq: int) -> Outcome:
        return self._limits

    def _halt(self) -> None:
        self._motion = Motion.HALTED
        self._plant.halt()

    def _cut(self) -> None:
        self._halt()

    def _advance_plant(self, to_us: int) -> None:
        self._plant.advance(to_us)

    def _events_us(self) -> Iterator[int | None]:
        yield from super()._events_us()
        if self._motion is Motion.TURNING:
            yield self._plant.arrives_us

    def _observe(self) -> None:
        if self._motion is Motion.TURNING:
            self._look_whether_there()
        self._latch_broken(self._plant.broken)

    def _look_whether_there(self) -> None:
        arrives_us = self._plant.arrives_us
        if arrives_us is None or arrives_us <= self._now_us:
            self._motion = Motion.DONE
            self._deadline_us = None  # a head that is there holds still without one
            self._outbox.tell(self._aim_report())

    def _reports(self) -> tuple[Message, ...]:
        return (self._aim_report(),)

    def _aim_report(self) -> AimReport:
        return AimReport(self._now_us, *tenth_mrad(self._plant), self._aim_seq, self._motion)


def limits_of(plant: HeadPlant) -> Limits:
    """Return a head's limits, rounded inwards."""
    pan_min, pan_max, tilt_min, tilt_max = plant.limits_rad
    return Limits(
        math.ceil(pan_min * PER_RAD),
        math.floor(pan_max * PER_RAD),
        math.ceil(tilt_min * PER_RAD),
        math.floor(tilt_max * PER_RAD),
    )


def tenth_mrad(plant: HeadPlant) -> tuple[int, int]:
    """Return where a head points."""
    pan_rad, tilt_rad = plant.angles_rad
    return round(pan_rad * PER_RAD), round(tilt_rad * PER_RAD)
