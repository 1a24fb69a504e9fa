"""What is said on the way."""

import pytest

from robotd.contract.events import Event, MissionPhase, MissionProgress, SweepProgress
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.mission.missions.context import Reporter, SweepCounter


def reading(status: ReadingStatus) -> RangeReading:
    measured = status in {ReadingStatus.OK, ReadingStatus.MISS}
    return RangeReading(0, 0.0, status, 1.0 if measured else None)


async def test_every_tenth_reading_and_the_last_are_told_by_kind() -> None:
    said: list[Event] = []
    counter = SweepCounter(3, 24, said.append)
    for number in range(24):
        counter.note(
            reading((ReadingStatus.OK, ReadingStatus.MISS, ReadingStatus.WEAK, ReadingStatus.TIMEOUT)[number % 4])
        )
    counts = [(e.number, e.taken, e.total, e.hits, e.misses, e.rejected) for e in said if isinstance(e, SweepProgress)]
    assert counts == [(3, 10, 24, 3, 3, 4), (3, 20, 24, 5, 5, 10), (3, 24, 24, 6, 6, 12)]


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
