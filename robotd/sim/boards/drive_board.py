"""The emulated board of the synchro-drive base."""

from collections.abc import Iterator

from firmware_proto.common import BoardKind, Fault, Result
from firmware_proto.drive_messages import TTL_LIMIT_MS, DriveReport, OdometryReport, SetVelocity
from firmware_proto.schema import Message
from robotd.sim.boards.emulated_board import Board, Outcome
from robotd.sim.physics.plant import DrivePlant

WATCH_US = 10_000
"""How often a moving base looks at its bumpers."""


class DriveBoard(Board):
    """Drives a :class:`DrivePlant` as PROTOCOL.md says."""

    def __init__(self, plant: DrivePlant, *, boot_id: int) -> None:
        self._plant = plant
        self._wanted = False
        self._moving = False
        self._bumpers = 0
        super().__init__(BoardKind.DRIVE, {SetVelocity: self._set_velocity}, boot_id=boot_id)

    def _set_velocity(self, wanted: SetVelocity, seq: int) -> Outcome:
        if not wanted.ttl_ms:
            return Result.BAD_VALUE
        self._plant.command(wanted.speed_mmps / 1000, wanted.turn_mradps / 1000)
        self._wanted = bool(wanted.speed_mmps or wanted.turn_mradps)
        self._deadline_us = None  # that of a standstill runs out without a fault
        if self._wanted:
            self._grant(min(wanted.ttl_ms, TTL_LIMIT_MS))
        return Result.OK

    def _halt(self) -> None:
        self._wanted = False
        self._plant.command(0.0, 0.0)

    def _cut(self) -> None:
        self._wanted = False
        self._plant.cut()

    def _advance_plant(self, to_us: int) -> None:
        self._plant.advance(to_us)

    def _events_us(self) -> Iterator[int | None]:
        yield from super()._events_us()
        if self._moving:
            yield (self._now_us // WATCH_US + 1) * WATCH_US  # a fixed grid: who calls how often changes nothing

    def _observe(self) -> None:
        was_moving = self._moving
        self._moving = self._wanted or any(self._velocity())
        pressed = self._plant.bumpers
        # One that stays pressed is not pressed again: after Clear and Arm the base can back away (PROTOCOL.md).
        newly = pressed & ~self._bumpers
        if pressed != self._bumpers:
            self._bumpers = pressed
            self._outbox.tell(self._drive_report())
        if newly and (was_moving or self._moving):  # the wall it hit may have stopped it already
            self._latch(Fault.BUMPER, cut=True)
        self._latch_broken(self._plant.broken)

    def _velocity(self) -> tuple[int, int]:
        speed_mps, turn_radps = self._plant.velocity
        return signed16(speed_mps * 1000), signed16(turn_radps * 1000)

    def _reports(self) -> tuple[Message, ...]:
        translate, rotate = self._plant.counts
        odometry = OdometryReport(self._now_us, signed32(translate), signed32(rotate), *self._velocity())
        return odometry, self._drive_report()

    def _drive_report(self) -> DriveReport:
        return DriveReport(self._now_us, min(max(self._plant.battery_mv, 0), 0xFFFF), self._bumpers & 0xFFFF)


def signed16(value: float) -> int:
    """Round to what a register of 16 bits can hold."""
    return max(-(1 << 15), min(round(value), (1 << 15) - 1))


def signed32(count: int) -> int:
    """Wrap a count as a register of 32 bits does."""
    return (count + (1 << 31)) % (1 << 32) - (1 << 31)
