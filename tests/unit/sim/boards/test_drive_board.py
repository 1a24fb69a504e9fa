"""What the emulated drive board does with its base: motion, deadman, bumpers, odometry."""

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
from firmware_proto.drive_messages import DriveReport, OdometryReport, SetVelocity
from firmware_proto.schema import Message
from robotd.sim.boards.drive_board import DriveBoard
from tests.unit.sim.boards.conftest import START_US, Host


@dataclass
class Base:
    """A base that takes up any velocity at once, and remembers what it was told."""

    velocity: tuple[float, float] = (0.0, 0.0)
    bumpers: int = 0
    counts: tuple[int, int] = (0, 0)
    battery_mv: int = 24_000
    broken: Fault = Fault.NONE
    hits_at_us: int | None = None
    told: list[str] = field(default_factory=list)

    def advance(self, to_us: int) -> None:
        if self.hits_at_us is not None and to_us >= self.hits_at_us and any(self.velocity):
            self.bumpers = 0b100
            self.velocity = (0.0, 0.0)
        self.counts = (to_us, -to_us)

    def command(self, speed_mps: float, turn_radps: float) -> None:
        self.velocity = (speed_mps, turn_radps)
        self.told.append(f"command {speed_mps} {turn_radps}")

    def cut(self) -> None:
        self.velocity = (0.0, 0.0)
        self.told.append("cut")


def _drive(base: Base, telemetry_ms: int = 60_000, ttl_max_ms: int = 5000) -> Host:
    host = Host(DriveBoard(base, boot_id=1), BoardKind.DRIVE, telemetry_ms=telemetry_ms, ttl_max_ms=ttl_max_ms)
    base.told.clear()
    return host


def test_a_set_point_reaches_the_base_in_metres() -> None:
    base = Base()
    assert _drive(base).say(SetVelocity(300, -500, 250)) == [Ack(0)]
    assert base.told == ["command 0.3 -0.5"]


def test_a_moving_set_point_that_outlives_its_ttl_ramps_down_and_latches() -> None:
    base = Base()
    host = _drive(base)
    host.say(SetVelocity(300, 0, 250))
    assert host.wait(249.999) == []
    (status,) = host.wait(0.001)
    assert status == BoardStatus(START_US + 250_000, BoardState.FAULT, Fault.DEADMAN, 0, 0, 0)
    assert base.told == ["command 0.3 0.0", "command 0.0 0.0"]
    assert host.say(SetVelocity(300, 0, 250)) == [Nack(Result.WRONG_STATE, SetVelocity.TYPE)]


def test_turning_on_the_spot_is_motion_too() -> None:
    host = _drive(Base())
    host.say(SetVelocity(0, 1, 100))
    host.wait(100)
    assert host.board.faults == Fault.DEADMAN


def test_a_newer_set_point_renews_the_ttl() -> None:
    host = _drive(Base())
    for _ in range(10):
        host.say(SetVelocity(300, 0, 250))
        host.wait(200)
    assert host.state() is BoardState.ARMED


def test_a_newer_set_point_may_shorten_the_ttl() -> None:
    host = _drive(Base())
    host.say(SetVelocity(300, 0, 900))
    host.say(SetVelocity(300, 0, 100))
    host.wait(100)
    assert host.state() is BoardState.FAULT


def test_a_zero_set_point_expires_without_a_fault() -> None:
    host = _drive(Base())
    host.say(SetVelocity(300, 0, 250))
    host.say(SetVelocity(0, 0, 250))
    host.wait(10_000)
    assert host.state() is BoardState.ARMED


@pytest.mark.parametrize(("ttl_max_ms", "granted_ms"), [(300, 300), (60_000, 1000)])
def test_a_long_ttl_is_capped(ttl_max_ms: int, granted_ms: int) -> None:
    host = _drive(Base(), ttl_max_ms=ttl_max_ms)
    host.say(SetVelocity(300, 0, 60_000))
    host.wait(granted_ms - 0.001)
    assert host.state() is BoardState.ARMED
    host.wait(0.001)
    assert host.state() is BoardState.FAULT


@pytest.mark.parametrize("impossible", [SetVelocity(300, 0, 0), SetVelocity(0, 0, 0)])
def test_a_set_point_without_a_ttl_is_refused_and_changes_nothing(impossible: SetVelocity) -> None:
    base = Base()
    host = _drive(base)
    assert host.say(impossible) == [Nack(Result.BAD_VALUE, SetVelocity.TYPE)]
    assert base.told == []


@pytest.mark.parametrize(
    ("request_", "told", "state"),
    [
        (Stop(), "command 0.0 0.0", BoardState.CONFIGURED),
        (Disarm(), "command 0.0 0.0", BoardState.CONFIGURED),
        (Clear(), "command 0.0 0.0", BoardState.CONFIGURED),
        (Configure(100, 100), "command 0.0 0.0", BoardState.CONFIGURED),
        (Hello(1, 0, 9), "command 0.0 0.0", BoardState.IDENTIFIED),
        (Kill(), "cut", BoardState.FAULT),
    ],
)
def test_whatever_disarms_brings_a_moving_base_to_rest(request_: Message, told: str, state: BoardState) -> None:
    base = Base()
    host = _drive(base)
    host.say(SetVelocity(300, 0, 250))
    host.say(request_)
    host.wait(300)
    assert base.told == ["command 0.3 0.0", told]
    assert host.state() is state
    assert host.board.faults in {Fault.NONE, Fault.KILLED}


def test_a_reboot_cuts_the_motors() -> None:
    base = Base()
    host = _drive(base)
    host.say(SetVelocity(300, 0, 250))
    host.board.reboot(2)
    assert base.told[-1] == "cut"


def test_a_bumper_pressed_while_moving_cuts_and_latches_within_a_watch() -> None:
    base = Base(hits_at_us=START_US + 33_000)
    host = _drive(base)
    host.wait(3)  # the watch keeps its own grid
    host.say(SetVelocity(300, 0, 250))
    report, status = host.wait(100)
    assert report == DriveReport(START_US + 40_000, 24_000, 0b100)
    assert status == BoardStatus(START_US + 40_000, BoardState.FAULT, Fault.BUMPER, 0, 0, 0)
    assert base.told[-1] == "cut"


def test_a_bumper_pressed_while_coasting_still_cuts() -> None:
    base = Base()
    host = _drive(base)
    host.say(SetVelocity(300, 0, 250))
    host.say(SetVelocity(0, 0, 250))
    base.velocity = (0.05, 0.0)
    host.wait(20)
    base.bumpers = 1
    base.velocity = (0.0, 0.0)  # by the wall
    host.wait(10)
    assert host.board.faults == Fault.BUMPER


def test_a_bumper_pressed_before_the_base_has_picked_up_speed_cuts() -> None:
    base = Base()
    host = _drive(base)
    host.say(SetVelocity(300, 0, 250))
    base.velocity = (0.0, 0.0)
    host.wait(10)
    base.bumpers = 1
    host.wait(10)
    assert host.board.faults == Fault.BUMPER


def test_a_bumper_pressed_after_a_stop_only_reports() -> None:
    base = Base()
    host = _drive(base)
    host.say(SetVelocity(300, 0, 250))
    host.say(Stop())
    host.wait(10)
    base.bumpers = 1
    assert host.wait(10) == [DriveReport(START_US + 20_000, 24_000, 1)]
    assert host.state() is BoardState.CONFIGURED


def test_a_bumper_pressed_while_standing_only_reports() -> None:
    base = Base()
    host = _drive(base, telemetry_ms=50)
    base.bumpers = 0x8001
    told = [one for one in host.wait(50) if isinstance(one, DriveReport)]
    assert told[0] == DriveReport(START_US + 50_000, 24_000, 0x8001)
    assert host.state() is BoardState.ARMED


def test_a_bumper_that_stays_pressed_lets_the_base_back_away() -> None:
    base = Base(hits_at_us=START_US)
    host = _drive(base)
    host.say(SetVelocity(300, 0, 250))
    host.wait(20)
    base.hits_at_us = None
    assert host.board.faults == Fault.BUMPER
    host.say(Clear())
    host.say(Arm())
    host.say(SetVelocity(-100, 0, 250))
    host.wait(50)
    assert host.state() is BoardState.ARMED
    base.bumpers = 0b1100
    host.wait(20)
    assert host.board.faults == Fault.BUMPER
    host.say(Clear())
    host.say(Arm())
    host.say(SetVelocity(-100, 0, 250))
    base.bumpers = 0b1000
    host.wait(20)
    base.bumpers = 0
    host.wait(20)
    assert host.state() is BoardState.ARMED


def test_faults_add_up() -> None:
    base = Base()
    host = _drive(base)
    host.say(SetVelocity(300, 0, 100))
    host.wait(100)
    base.velocity = (0.2, 0.0)  # still ramping down
    host.wait(5)
    base.bumpers = 1
    host.wait(10)
    host.say(Kill())
    assert host.board.faults == Fault.DEADMAN | Fault.BUMPER | Fault.KILLED


def test_odometry_wraps_as_a_register_does_and_never_overflows() -> None:
    base = Base(battery_mv=70_000)
    host = _drive(base)
    host.now_us += (1 << 31) - START_US - 50_000
    host.say(Configure(50, 500))
    base.velocity = (99.0, -99.0)
    host.heard()
    _, odometry, drive = host.wait(50)
    assert odometry == OdometryReport(1 << 31, -(1 << 31), -(1 << 31), 32767, -32768)
    assert drive == DriveReport(1 << 31, 65535, 0)
