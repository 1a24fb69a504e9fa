"""A part of what ``make stops`` tries: the robot comes to rest whatever ends its daemon, whatever its devices speak."""

from importlib.util import find_spec

import pytest

from robotd.sim.emulators.catalogue import Dialects, Firmware
from tests.studies.stops.causes import ENDINGS, HEAD_LOST
from tests.studies.stops.processes import STALL, run_real_trials
from tests.studies.stops.trial import run_trial

needs_c = pytest.mark.skipif(find_spec("robotd.sim.firmware._native") is None, reason="there was no C compiler")
BASES = {
    "board": Dialects(),
    "board in C": Dialects(boards=Firmware.C),
    "rwi-ascii": Dialects(drive="rwi-ascii"),
    "rflex": Dialects(drive="rflex"),
}
HEADS = {
    "board": Dialects(),
    "board in C": Dialects(boards=Firmware.C),
    "ptu": Dialects(pantilt="ptu"),
    "dynamixel": Dialects(pantilt="dynamixel"),
}
SOON_S = 0.05
ENDED_S = 0.5
"""It waits for no device longer than 0.3 s, and each may fail where the one before has come to rest."""
REST_S = 1.0
"""From cruising speed."""


def check(dialects: Dialects, activity: str, cause: str, seed: int) -> None:
    outcome = run_trial(dialects, activity, cause, seed)
    assert outcome.rest_s is not None, outcome
    assert outcome.rest_s < REST_S
    assert outcome.stop_s is not None, outcome
    assert outcome.stop_s < SOON_S
    assert outcome.ended_s < ENDED_S or cause not in ENDINGS


@pytest.mark.parametrize("cause", ENDINGS)
def test_a_base_that_hears_one_order_of_a_burst_comes_to_rest(cause: str) -> None:
    for number, activity in enumerate(("turning", "driving")):
        check(BASES["rflex"], activity, cause, number)


@pytest.mark.parametrize("cause", ["SIGHUP", "SIGABRT", "error: supervisor"])
@pytest.mark.parametrize("dialect", [pytest.param(one, marks=needs_c if "C" in one else ()) for one in BASES])
def test_every_base_comes_to_rest(dialect: str, cause: str) -> None:
    check(BASES[dialect], "driving", cause, 7)


@pytest.mark.parametrize("cause", ["SIGHUP", "SIGABRT", "error: supervisor"])
@pytest.mark.parametrize("dialect", [pytest.param(one, marks=needs_c if "C" in one else ()) for one in HEADS])
def test_every_head_comes_to_rest(dialect: str, cause: str) -> None:
    check(HEADS[dialect], "head", cause, 7)


@pytest.mark.parametrize("cause", ["SIGTERM", "error: supervisor"])
def test_a_base_that_was_left_driving_is_halted_though_the_next_daemon_fails_as_it_starts(cause: str) -> None:
    for seed in range(3):
        check(BASES["rflex"], "start-up", cause, seed)


@pytest.mark.parametrize("cause", ["stop", "lease", HEAD_LOST])
def test_a_base_that_hears_one_order_of_a_burst_obeys_every_ordinary_stop(cause: str) -> None:
    for number, activity in enumerate(("turning", "driving")):
        check(BASES["rflex"], activity, cause, number)


@pytest.mark.real_clock
@pytest.mark.parametrize("cause", ["SIGHUP", "SIGABRT", STALL])
def test_a_real_daemon_halts_a_base_that_hears_one_order_of_a_burst(cause: str) -> None:
    (rest_s,) = run_real_trials(BASES["rflex"], "turning", cause, 1)
    assert rest_s is not None
