"""A few lies of each robot in each state; ``make liars`` tells 10 000."""

import pytest

from robotd.hardware.devices import board_drive, board_pantilt, credible
from robotd.hardware.link.clock_sync import ClockSync
from robotd.sim.emulators.catalogue import DRIVES, PANTILTS, RANGEFINDERS
from tests.studies.liars.block import ROBOTS, run_block
from tests.studies.liars.lies import TONGUES
from tests.studies.liars.trial import STATES

_WITHOUT_WORDS = {("pantilt", "fixed")}
_LIKE_ANOTHER = {("rangefinder", name) for name in ("tfmini", "tfmini-plus", "tf-luna")}
"""They say the data frames of the tfmini-s."""


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("robot", ROBOTS)
def test_the_daemon_lives_rests_and_says_what_is_wrong(robot: str, state: str) -> None:
    outcomes = run_block(robot, state, range(1, 4))
    assert [outcome for outcome in outcomes if outcome.is_failure] == []


def test_every_dialect_has_a_liar_in_some_robot() -> None:
    tables = {"drive": DRIVES, "pantilt": PANTILTS, "rangefinder": RANGEFINDERS}
    spoken = {(device, dialect) for device, table in tables.items() for dialect in table}
    assert set(TONGUES) == spoken - _WITHOUT_WORDS - _LIKE_ANOTHER
    assert {(device, getattr(robot, device)) for robot in ROBOTS.values() for device in tables} >= set(TONGUES)


def test_a_trial_can_be_done_again() -> None:
    assert run_block("own boards", "drive", range(7, 9)) == run_block("own boards", "drive", range(7, 9))


@pytest.mark.parametrize("state", ["disarmed", "map: sweep"])
def test_without_the_gate_it_would_be_seen(monkeypatch: pytest.MonkeyPatch, state: str) -> None:
    for name in ("check", "check_periodic"):
        monkeypatch.setattr(credible.Times, name, lambda *_: None)
    monkeypatch.setattr(board_pantilt, "check_readback", lambda *_: None)
    monkeypatch.setattr(board_drive, "check_twist", lambda *_: None)
    monkeypatch.setattr(ClockSync, "ahead_ns", lambda *_: 0)
    outcomes = (
        outcome for seed in range(1, 40, 3) for outcome in run_block("own boards", state, range(seed, seed + 3))
    )
    assert any(outcome.end in {"died", "internal", "froze"} for outcome in outcomes)
