from hypothesis import given
from hypothesis import strategies as st

from firmware_proto.rangefinder_messages import ShotStatus
from robotd.sim.hosting.board_clock import BoardClock, HeadOnClock, LaserOnClock
from robotd.sim.physics.plant import ShotAnswer
from robotd.sim.physics.steppers import StepperHead, StepperSettings

CLOCKS = st.builds(BoardClock, st.integers(0, 10**9), st.integers(-200_000, 200_000))
TIMES = st.integers(0, 10**15)


@given(CLOCKS, TIMES)
def test_true_time_is_the_earliest_at_which_the_board_shows_it(clock: BoardClock, true_us: int) -> None:
    shown_us = clock.board_us(true_us)
    back_us = clock.true_us(shown_us)
    assert clock.board_us(back_us) >= shown_us > clock.board_us(back_us - 1)
    assert abs(back_us - true_us) <= 1


@given(CLOCKS, TIMES, st.integers(0, 10**6))
def test_time_only_grows(clock: BoardClock, true_us: int, more_us: int) -> None:
    assert clock.board_us(true_us) <= clock.board_us(true_us + more_us)


def test_a_skewed_clock_gains_what_it_says() -> None:
    clock = BoardClock(offset_us=5, skew_ppb=50_000)
    assert clock.board_us(1_000_000_000) == 5 + 1_000_050_000


def test_clocks_of_a_seed_differ_by_device_and_stay_the_same() -> None:
    drive = BoardClock.of_seed(3, "drive", 40.0)
    assert drive == BoardClock.of_seed(3, "drive", 40.0)
    assert drive != BoardClock.of_seed(3, "pantilt", 40.0)
    assert abs(drive.skew_ppb) <= 40_000


@given(CLOCKS, TIMES)
def test_a_head_has_arrived_when_its_board_is_told_so(clock: BoardClock, start_us: int) -> None:
    head = HeadOnClock(StepperHead(StepperSettings()), clock)
    head.advance(clock.board_us(start_us))
    head.aim(1.0, 0.0)
    arrives_us = head.arrives_us
    assert arrives_us is not None
    head.advance(arrives_us)
    assert head.arrives_us is None


class Stopwatch:
    """A laser that notes when it shot."""

    def __init__(self) -> None:
        self.shot_us = 0

    def switch(self, *, on: bool) -> None: ...

    def shoot(self, at_us: int) -> ShotAnswer:
        self.shot_us = at_us
        return ShotAnswer(ShotStatus.OK, 1.0, 1, 10_000)

    def measure(self, at_us: int, pan_rad: float) -> ShotAnswer:
        return self.shoot(at_us)


@given(CLOCKS, TIMES)
def test_a_shot_happens_at_the_true_time_of_the_boards_moment(clock: BoardClock, true_us: int) -> None:
    plant = Stopwatch()
    answer = LaserOnClock(plant, clock).shoot(clock.board_us(true_us))
    assert abs(plant.shot_us - true_us) <= 1
    assert abs(answer.takes_us - 10_000) <= 4
