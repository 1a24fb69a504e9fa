"""The emulated board of the laser rangefinder."""

from collections.abc import Iterator

from firmware_proto.common import BoardKind, Result
from firmware_proto.rangefinder_messages import SetLaser, Shoot, Shot, ShotStatus
from firmware_proto.schema import Message
from robotd.sim.boards.emulated_board import Board, Handler, Outcome
from robotd.sim.physics.plant import LaserPlant, ShotAnswer


class RangefinderBoard(Board):
    """Shoots with a :class:`LaserPlant` as PROTOCOL.md says."""

    def __init__(self, plant: LaserPlant, *, boot_id: int) -> None:
        self._plant = plant
        self._lit = False
        self._pending: tuple[int, int, Shot] | None = None
        """When it is ready, the seq of its request, and the answer."""
        handlers: dict[type[Message], Handler] = {SetLaser: self._set_laser, Shoot: self._shoot}
        super().__init__(BoardKind.RANGEFINDER, handlers, boot_id=boot_id)

    def _set_laser(self, laser: SetLaser, seq: int) -> Outcome:
        if laser.on not in {0, 1}:
            return Result.BAD_VALUE
        if laser.on:
            self._lit = True
            self._plant.switch(on=True)
        else:
            self._halt()
        return Result.OK

    def _shoot(self, shoot: Shoot, seq: int) -> Outcome:
        if self._pending is not None:
            return Result.BUSY
        if not shoot.timeout_ms:
            return Result.BAD_VALUE
        if not self._lit:
            return Shot(self._now_us, 0, 0, ShotStatus.LASER_OFF)
        answer = self._plant.shoot(self._now_us)
        patience_us = shoot.timeout_ms * 1000
        if answer.takes_us > patience_us:  # it ends then, and says so
            answer = ShotAnswer(ShotStatus.DEVICE_ERROR, 0.0, 0, patience_us)
        self._pending = (self._now_us + answer.takes_us, seq, self._shot(answer))
        return None

    def _shot(self, answer: ShotAnswer) -> Shot:
        range_mm = round(answer.range_m * 1000) if answer.status is ShotStatus.OK else 0
        return Shot(self._now_us, range_mm, min(max(answer.strength, 0), 0xFFFF), answer.status)

    def _halt(self) -> None:
        self._lit = False
        self._plant.switch(on=False)
        if self._pending is None:
            return
        _, seq, shot = self._pending
        self._pending = None
        # At once: each request has its answer, even if the light goes off under it (PROTOCOL.md).
        self._answer_late(Shoot, seq, Shot(shot.board_us, 0, 0, ShotStatus.LASER_OFF))

    def _cut(self) -> None:
        self._halt()

    def _advance_plant(self, to_us: int) -> None:
        """Nothing moves beneath this board."""

    def _events_us(self) -> Iterator[int | None]:
        yield from super()._events_us()
        if self._pending is not None:
            yield self._pending[0]

    def _observe(self) -> None:
        if self._pending is None or self._pending[0] > self._now_us:
            return
        _, seq, shot = self._pending
        self._pending = None
        self._answer_late(Shoot, seq, shot)

    def _reports(self) -> tuple[Message, ...]:
        return ()
