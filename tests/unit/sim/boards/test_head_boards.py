"""What the emulated pan/tilt and rangefinder boards do with their devices: aim, shots, light."""

import time
from dataclasses import dataclass, field

import pytest

from firmware_proto.common import (
    Ack,
    Arm,
    BoardKind,
    BoardState,
    BoardStatus,
    Clear,
    Configure,
    Disarm,
    Fault,
    Hello,
    Kill,
    Nack,
    Result,
    Stop,
)
from firmware_proto.pantilt_messages import Aim, AimReadback, AimReport, Limits, Motion, ReadAim, ReadLimits
from firmware_proto.rangefinder_messages import SetLaser, Shoot, Shot, ShotStatus
from firmware_proto.schema import Message
from robotd.hardware.wire.board import Received
from robotd.sim.boards.pantilt_board import PanTiltBoard
from robotd.sim.boards.rangefinder_board import RangefinderBoard
from robotd.sim.physics.plant import ShotAnswer
from tests.unit.sim.boards.conftest import START_US, Host

# Pan/tilt


@dataclass
class Head:
    """A head that takes 100 ms for any motion."""

    limits_rad: tuple[float, float, float, float] = (-2.77507, 2.77507, -0.82, 0.54)
    angles_rad: tuple[float, float] = (0.0, 0.0)
    arrives_us: int | None = None
    broken: Fault = Fault.NONE
    now_us: int = 0
    aims: list[tuple[float, float]] = field(default_factory=list)

    def advance(self, to_us: int) -> None:
        self.now_us = to_us
        if self.arrives_us is not None and to_us >= self.arrives_us:
            self.arrives_us = None
            self.angles_rad = self.aims[-1]

    def aim(self, pan_rad: float, tilt_rad: float) -> None:
        self.aims.append((pan_rad, tilt_rad))
        self.arrives_us = None if (pan_rad, tilt_rad) == self.angles_rad else self.now_us + 100_000

    def halt(self) -> None:
        self.arrives_us = None


def _pantilt(head: Head, telemetry_ms: int = 60_000, ttl_max_ms: int = 5000) -> Host:
    board = PanTiltBoard(head, boot_id=1)
    return Host(board, BoardKind.PANTILT, telemetry_ms=telemetry_ms, ttl_max_ms=ttl_max_ms)


def test_an_aim_is_acknowledged_and_its_end_reported_at_once() -> None:
    head = Head()
    host = _pantilt(head)
    assert host.say(Aim(15708, -873, 2000), seq=7) == [Ack(0)]
    assert head.aims == [(1.5708, -0.0873)]
    assert host.wait(99.999) == []
    assert host.wait(500) == [AimReport(START_US + 100_000, 15708, -873, 7, Motion.DONE)]
    host.wait(10_000)
    assert host.state() is BoardState.ARMED


def test_an_aim_at_where_the_head_is_ends_after_its_ack() -> None:
    assert _pantilt(Head()).say(Aim(0, 0, 100), seq=3) == [Ack(0), AimReport(START_US, 0, 0, 3, Motion.DONE)]


def test_the_newest_aim_wins_and_only_it_is_done() -> None:
    head = Head()
    host = _pantilt(head)
    host.say(Aim(1000, 0, 500), seq=1)
    host.wait(50)
    host.say(Aim(2000, 0, 500), seq=2)
    assert host.wait(1000) == [AimReport(START_US + 150_000, 2000, 0, 2, Motion.DONE)]


def test_a_repeated_aim_is_not_started_again() -> None:
    head = Head()
    host = _pantilt(head)
    assert host.say(Aim(1000, 0, 500), seq=1) == host.say(Aim(1000, 0, 500), seq=1) == [Ack(0)]
    assert len(head.aims) == 1


def test_an_aim_that_outlives_its_ttl_halts_and_latches() -> None:
    head = Head()
    host = _pantilt(head)
    host.say(Aim(1000, 0, 60))
    (status,) = host.wait(500)
    assert status == BoardStatus(START_US + 60_000, BoardState.FAULT, Fault.DEADMAN, 0, 0, 0)
    assert head.arrives_us is None


def test_an_aim_done_exactly_in_time_is_done() -> None:
    host = _pantilt(Head())
    host.say(Aim(1000, 0, 100), seq=5)
    assert host.wait(500) == [AimReport(START_US + 100_000, 1000, 0, 5, Motion.DONE)]


@pytest.mark.parametrize(
    "impossible", [Aim(27751, 0, 100), Aim(-27751, 0, 100), Aim(0, 5401, 100), Aim(0, -8201, 100), Aim(0, 0, 0)]
)
def test_an_aim_outside_the_limits_or_without_a_ttl_is_refused(impossible: Aim) -> None:
    head = Head()
    assert _pantilt(head).say(impossible) == [Nack(Result.BAD_VALUE, Aim.TYPE)]
    assert head.aims == []


def test_the_limits_it_names_can_be_reached() -> None:
    host = _pantilt(Head())
    (limits,) = host.say(ReadLimits())
    assert limits == Limits(-27750, 27750, -8200, 5400)
    assert host.say(Aim(27750, 5400, 500)) == [Ack(0)]
    assert host.say(Aim(-27750, -8200, 500)) == [Ack(0)]


@pytest.mark.parametrize("request_", [Stop(), Disarm(), Kill(), Clear(), Hello(1, 0, 2), Configure(50, 50)])
def test_a_head_halted_half_way_never_claims_to_have_arrived(request_: Message) -> None:
    host = _pantilt(Head())
    host.say(Aim(1000, 0, 500), seq=1)
    host.wait(50)
    host.say(request_)
    (readback,) = host.say(ReadAim())
    assert isinstance(readback, AimReadback)
    assert readback.moving == Motion.HALTED


def test_a_session_begins_with_no_aim_done() -> None:
    host = _pantilt(Head())
    host.say(Aim(0, 0, 500), seq=0)
    host.say(Hello(1, 0, 2))
    assert host.say(ReadAim()) == [AimReadback(START_US, 0, 0, 0, Motion.HALTED)]


def test_where_the_head_points_is_reported_in_the_period() -> None:
    host = _pantilt(Head(), telemetry_ms=30)
    host.say(Aim(1000, 0, 500), seq=9)
    reports = [one for one in host.wait(130) if isinstance(one, AimReport)]
    assert [one.moving for one in reports] == [Motion.TURNING] * 3 + [Motion.DONE] * 2
    assert [one.board_us - START_US for one in reports] == [30_000, 60_000, 90_000, 100_000, 120_000]


# Rangefinder


@dataclass
class Laser:
    """A laser that sees the same wall always."""

    answer: ShotAnswer = field(default_factory=lambda: ShotAnswer(ShotStatus.OK, 2.3454, 412, 8000))
    on: bool = False
    shots: list[int] = field(default_factory=list)

    def switch(self, *, on: bool) -> None:
        self.on = on

    def shoot(self, at_us: int) -> ShotAnswer:
        self.shots.append(at_us)
        return self.answer


def _rangefinder(laser: Laser, *, lit: bool = True) -> Host:
    host = Host(RangefinderBoard(laser, boot_id=1), BoardKind.RANGEFINDER)
    if lit:
        assert host.say(SetLaser(1)) == [Ack(0)]
    return host


def test_a_shot_is_answered_when_it_is_measured_with_the_time_of_its_light() -> None:
    laser = Laser()
    host = _rangefinder(laser)
    assert host.say(Shoot(100), seq=4) == []
    assert host.board.next_event_us == START_US + 8000
    assert host.wait(7.999) == []
    host.board.advance(START_US + 8000)
    assert host.received() == [Received(0xB1, 4, Shot(START_US, 2345, 412, ShotStatus.OK))]
    assert laser.shots == [START_US]


def test_a_repeated_shoot_repeats_the_same_shot() -> None:
    laser = Laser()
    host = _rangefinder(laser)
    host.say(Shoot(100), seq=4)
    assert host.say(Shoot(100), seq=4) == []
    (first,) = host.wait(10)
    assert host.say(Shoot(100), seq=4) == [first]
    assert laser.shots == [START_US]
    host.say(Shoot(100), seq=5)
    assert len(laser.shots) == 2


def test_a_shot_under_way_makes_the_next_one_busy_but_not_forever() -> None:
    laser = Laser()
    host = _rangefinder(laser)
    host.say(Shoot(100), seq=4)
    assert host.say(Shoot(100), seq=5) == [Nack(Result.BUSY, Shoot.TYPE)]
    assert host.say(Shoot(100), seq=4) == []  # the refusal did not make it forget the shot under way
    assert len(host.wait(10)) == 1
    assert host.say(Shoot(100), seq=5) == []
    assert len(host.wait(10)) == 1


def test_a_shot_without_light_says_so() -> None:
    laser = Laser()
    host = _rangefinder(laser, lit=False)
    assert host.say(Shoot(100)) == [Shot(START_US, 0, 0, ShotStatus.LASER_OFF)]
    assert laser.shots == []


@pytest.mark.parametrize("status", [one for one in ShotStatus if one is not ShotStatus.OK])
def test_no_distance_is_given_unless_it_was_measured(status: ShotStatus) -> None:
    host = _rangefinder(Laser(ShotAnswer(status, 3.0, 70_000, 0)))
    assert host.say(Shoot(100)) == [Shot(START_US, 0, 65535, status)]


def test_a_measurement_that_takes_too_long_ends_in_time() -> None:
    host = _rangefinder(Laser(ShotAnswer(ShotStatus.OK, 3.0, 5, 200_000)))
    host.say(Shoot(50))
    assert host.wait(49.999) == []
    assert host.wait(0.001) == [Shot(START_US, 0, 0, ShotStatus.DEVICE_ERROR)]


@pytest.mark.parametrize("request_", [SetLaser(0), Stop(), Disarm(), Kill(), Clear(), Configure(60_000, 9)])
def test_whatever_puts_the_light_out_answers_the_shot_under_way(request_: Message) -> None:
    laser = Laser()
    host = _rangefinder(laser)
    host.say(Shoot(100))
    said = [one for one in host.say(request_) if isinstance(one, Shot)]
    assert said == [Shot(START_US, 0, 0, ShotStatus.LASER_OFF)]
    assert not laser.on
    assert not [one for one in host.wait(100) if isinstance(one, Shot)]


def test_arming_leaves_the_light_as_it_is() -> None:
    laser = Laser()
    host = _rangefinder(laser)
    host.say(Arm())
    assert laser.on


def test_a_reboot_puts_the_light_out_and_forgets_the_shot() -> None:
    laser = Laser()
    host = _rangefinder(laser)
    host.say(Shoot(100))
    host.board.reboot(2)
    assert not laser.on
    assert host.wait(100) == []


@pytest.mark.parametrize(("request_"), [SetLaser(2), Shoot(0)])
def test_impossible_values_are_refused(request_: Message) -> None:
    assert _rangefinder(Laser()).say(request_) == [Nack(Result.BAD_VALUE, request_.TYPE)]


def test_a_sweep_of_shots_costs_little() -> None:
    host = _rangefinder(Laser())
    start_s = time.process_time()
    for _ in range(300):
        host.say(Shoot(100))
        assert len(host.wait(10)) == 1
    assert time.process_time() - start_s < 1.0
