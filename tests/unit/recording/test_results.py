"""A result's digest stands for all of it but its time."""

from dataclasses import replace

import pytest

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import Event, MissionPhase, MissionProgress, SweepDone
from robotd.core.pose import IDENTITY, STANDSTILL, Odometry
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.head.jobs import Inserted
from robotd.mission.news import News
from robotd.mission.whereabouts.whereabouts import unlocalized
from robotd.recording.entries import ResultEntry
from robotd.recording.results import map_result, result_of
from tests.support.memory_journal import MemoryJournal
from tests.support.places import place

READING = RangeReading(10, 0.5, ReadingStatus.OK, 2.0)
SWEEP = Sweep(0, IDENTITY, (READING, RangeReading(20, 1.5, ReadingStatus.WEAK, None)))
END = MissionProgress(1, 7, "map", MissionPhase.DONE, 2, 2, "2 stops swept")


def noted(event: Event, made: ResultEntry | None = None) -> ResultEntry | None:
    journal = MemoryJournal()
    News(journal.note).publish(event, made)
    entries = [entry for entry in journal.entries if isinstance(entry, ResultEntry)]
    assert len(entries) <= 1
    return entries[0] if entries else None


def digest(event: Event, made: ResultEntry | None = None) -> str:
    entry = noted(event, made)
    assert entry is not None
    return entry.digest


def test_times_are_left_out_of_a_digest_and_everything_else_is_in_it() -> None:
    later = tuple(replace(reading, time_ns=reading.time_ns + 5) for reading in SWEEP.readings)
    other = (replace(READING, range_m=2.000001), SWEEP.readings[1])
    assert digest(SweepDone(1, SWEEP)) == digest(SweepDone(9, replace(SWEEP, readings=later)))
    assert digest(SweepDone(1, SWEEP)) != digest(SweepDone(1, replace(SWEEP, readings=other)))
    assert digest(unlocalized(1, "m")) == digest(unlocalized(2, "m")) != digest(unlocalized(1, "n"))
    assert digest(END) == digest(replace(END, time_ns=9)) != digest(replace(END, message="1 stop swept"))


def test_a_map_is_noted_whenever_it_changes() -> None:
    here = place("m")
    before = noted(here.whole(1), map_result(here.whole(1), here.digest))
    here.take(inserted := Inserted(b"", b"", "another", None))
    change = here.changes(2, inserted)
    after = noted(change, map_result(change, inserted.digest))
    assert before is not None
    assert after == ResultEntry(2, "map", {"map_id": "m", "generation": 1}, "another")
    assert after.digest != before.digest
    with pytest.raises(ValueError, match="noted by its digest"):
        noted(change)


def test_an_entry_that_was_made_where_the_estimate_was_is_noted_as_it_is() -> None:
    event = unlocalized(1, "m")
    made = result_of(event)
    assert made is not None
    assert made.encoded is not None
    assert noted(event, made) is made
    assert noted(event) == made


def test_what_is_no_result_is_not_noted() -> None:
    predicted = PoseEstimate(1, PoseState.PREDICTED, IDENTITY, (), 0, 0, True, "m")
    for event in (Odometry(1, IDENTITY, STANDSTILL), predicted, replace(END, phase=MissionPhase.SWEEPING)):
        assert noted(event) is None
