"""What is said on the way."""

import pytest

from robotd.contract.events import Event, MissionPhase, MissionProgress
from robotd.mission.missions.context import Reporter


@pytest.mark.parametrize("last", [MissionPhase.STOPPED, MissionPhase.FAILED])
async def test_a_mission_ends_at_the_stop_where_it_was(last: MissionPhase) -> None:
    said: list[Event] = []
    report = Reporter(7, "map", 5, lambda event, made=None: said.append(event))
    report.at(MissionPhase.STARTED)
    report.at(MissionPhase.SWEEPING, 3)
    report.at(MissionPhase.COMPUTING)
    report.at(last, message="why")
    steps = [event for event in said if isinstance(event, MissionProgress)]
    assert [(step.phase, step.stop) for step in steps[1:]] == [
        (MissionPhase.SWEEPING, 3),
        (MissionPhase.COMPUTING, 3),
        (last, 3),
    ]
    assert [step.is_last for step in steps] == [False, False, False, True]
    assert (steps[-1].message, steps[-1].stops, steps[-1].mission_id) == ("why", 5, 7)
