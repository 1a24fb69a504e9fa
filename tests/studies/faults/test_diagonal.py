"""A diagonal of the matrix of faults: each fault once, states and cables in turn; ``make faults`` runs all of it."""

import pytest

from robotd.sim.faults.fault_words import FAULTS
from robotd.sim.robot import DEVICES
from tests.studies.faults.cell import run_cell
from tests.support.states import STATES

DIAGONAL = [
    (fault, list(STATES)[number % len(STATES)], DEVICES[number % len(DEVICES)]) for number, fault in enumerate(FAULTS)
]
AT_SPEED = [(fault, "map: drive", "drive") for fault in ("unplug", "silence", "blocked", "garbage")]


@pytest.mark.parametrize(("fault", "state", "device"), DIAGONAL + AT_SPEED)
def test_the_robot_rests_and_everything_comes_back(fault: str, state: str, device: str) -> None:
    assert run_cell(fault, state, device).failures == ()


def test_a_fault_that_the_daemon_does_not_survive_would_be_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tests.studies.faults.cell.NOTICED_WITHIN_S", 0.2)
    monkeypatch.setattr("tests.studies.faults.cell.REST_AFTER_STOP_S", 0.5)
    assert "at rest after" in run_cell("unplug", "drive", "drive").failures[0]
