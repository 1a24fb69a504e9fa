"""What one source says never takes the memory of another."""

import os
from itertools import pairwise
from pathlib import Path

import pytest

from robotd.core.errors import RecordingError
from robotd.hardware.link.tap import Direction
from robotd.recording.budget import Budgets, Source, source_of
from robotd.recording.entries import (
    BytesEntry,
    CommandEntry,
    ComputedEntry,
    Entry,
    LineEntry,
    RecordingHeader,
    ResultEntry,
)
from robotd.recording.preroll import PrerollJournal
from robotd.recording.reader import read
from robotd.recording.recorder import Recorder

HEADER = RecordingHeader("0.1.0", "", 5, 1_700_000_000_000_000_001, 1000)
REQUEST = CommandEntry(3, "renew", {"mission_id": 1})
MAP = CommandEntry(4, "use_map", {"map_id": "d", "grid": {"cells": os.urandom(50_000).hex()}})
RESULT = ResultEntry(5, "estimate", {"x_m": 1.0}, "abc")


@pytest.mark.parametrize(
    ("entry", "source"),
    [
        (BytesEntry(1, "drive", Direction.FROM_BOARD, b"x"), Source.LINES),
        (LineEntry(1, "drive", up=True), Source.LINES),
        (REQUEST, Source.REQUESTS),
        (MAP, Source.MAPS),
        (RESULT, Source.RESULTS),
        (ComputedEntry(1, "rank", 0), Source.RESULTS),
    ],
)
def test_every_entry_has_a_source(entry: Entry, source: Source) -> None:
    assert source_of(entry) is source


def test_each_source_has_its_own_bound_and_one_entry_alone_is_always_taken() -> None:
    budgets = Budgets(100)
    assert budgets.use(Source.MAPS, 10_000)
    assert not budgets.use(Source.MAPS, 1)
    assert [budgets.use(Source.LINES, 50) for _ in range(3)] == [True, True, False]
    assert budgets.used_bytes == 10_151
    budgets.free()
    assert budgets.use(Source.MAPS, 1)


@pytest.mark.parametrize("flood", [REQUEST, RESULT, BytesEntry(1, "drive", Direction.FROM_BOARD, bytes(40))])
def test_a_flood_of_one_source_leaves_the_others_their_memory(flood: Entry) -> None:
    journal = PrerollJournal(HEADER, 20_000)
    for _ in range(60):
        journal.note(flood)
    journal.note(MAP)
    journal.note(BytesEntry(6, "pantilt", Direction.FROM_BOARD, bytes(4000)))
    assert len(journal.remembered) == 62


def test_what_used_up_the_preroll_is_named(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO")
    journal = PrerollJournal(HEADER, 2000)
    for _ in range(100):
        journal.note(REQUEST)
    with pytest.raises(RecordingError, match="requests of clients have used up the pre-roll of 2000 bytes"):
        journal.start(tmp_path / "a.mcap")
    assert [message for message in caplog.messages if "used up" in message] == [caplog.messages[0]]


def test_what_used_it_up_is_given_back_by_and_by() -> None:
    """All of it at once would keep the loop for longer than a stop may take."""
    journal = PrerollJournal(HEADER, 500_000)
    noted = 0
    while not noted or journal.remembered:
        journal.note(BytesEntry(-1, "drive", Direction.FROM_BOARD, Counted(b"%d" % noted)))
        noted += 1
    assert noted > 1000
    left = [Counted.alive]
    assert left[0] > 1000
    while left[-1]:
        journal.note(REQUEST)
        left.append(Counted.alive)
    assert max(before - after for before, after in pairwise(left)) < 300


class Counted(bytes):
    """Data that knows how much of it there is."""

    alive = 0

    def __init__(self, data: bytes) -> None:
        Counted.alive += 1

    def __del__(self) -> None:
        Counted.alive -= 1


def test_a_map_that_packs_badly_does_not_end_a_recording(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "a.mcap", HEADER, queue_bytes=20_000)
    lines = [BytesEntry(n, "drive", Direction.FROM_BOARD, bytes(40)) for n in range(50)]
    entries: list[Entry] = [*lines, MAP]
    for entry in entries:
        recorder.note(entry)
    recorder.close()
    assert recorder.error is None
    assert read(tmp_path / "a.mcap").entries == (*lines, MAP)
