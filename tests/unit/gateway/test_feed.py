"""What the daemon tells, kept and handed on: whatever gaps and restarts come, a browser ends knowing the same."""

import asyncio
import zlib
from collections.abc import AsyncGenerator
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.client import Gap
from robotd.contract.events import MapChanged
from robotd.contract.plain import from_plain
from robotd.contract.topics import Frame, Topic, encode_frame
from robotd.core.errors import RemoteProtocolError
from robotd.gateway.feed.fan_out import FanOut
from robotd.gateway.feed.heard_frames import HeardFrame
from robotd.gateway.feed.map_kept import MOST_CHANGES, MapKept, folded
from robotd.gateway.feed.page_outbox import MOST_BYTES, MOST_LINES, MOST_TEXTS, Full, PageOutbox
from robotd.gateway.feed.snapshot import Snapshot
from tests.unit.server.conftest import whole_map

ROWS, COLS = 6, 8


def read(data: bytes) -> HeardFrame:
    return HeardFrame.read(Frame.of(data))


def message(topic: Topic, event: str, seq: int, session: str = "s", **fields: Any) -> bytes:
    return encode_frame(topic, session, seq, {"event": event, "time_ns": seq, **fields})


def heard(topic: Topic, event: str, seq: int, session: str = "s", **fields: Any) -> HeardFrame:
    return read(message(topic, event, seq, session, **fields))


def whole(generation: int, values: bytes, session: str = "s", seq: int = 0, map_id: str = "m") -> HeardFrame:
    return heard(
        Topic.MAP, "map_changed", seq, session, map_id=map_id, generation=generation, whole=True, resolution_m=0.05,
        origin_x_m=0.0, origin_y_m=0.0, rows=ROWS, cols=COLS, cells_zlib=zlib.compress(values), indices_u32le=b"",
        values_u8=b"", stops=None,
    )  # fmt: skip


def change(generation: int, cell: int, value: int, session: str = "s", seq: int = 0) -> HeardFrame:
    return heard(
        Topic.MAP, "map_changed", seq, session, map_id="m", generation=generation, whole=False, resolution_m=0.05,
        origin_x_m=0.0, origin_y_m=0.0, rows=ROWS, cols=COLS, cells_zlib=b"",
        indices_u32le=cell.to_bytes(4, "little"), values_u8=bytes([value]), stops=None,
    )  # fmt: skip


EMPTY = bytes([128]) * (ROWS * COLS)


class Page:
    """A browser's view: lays in what it is sent, as the console does."""

    def __init__(self) -> None:
        self.cells: np.ndarray[Any, Any] | None = None
        self.generation = -1

    def take(self, frames: list[bytes]) -> None:
        for frame in frames:
            told = from_plain(MapChanged, read(frame).fields)
            if told.whole:
                self.cells, self.generation = np.array(told.values), told.generation
            elif told.generation == self.generation + 1 and self.cells is not None:
                self.cells.reshape(-1)[told.cells] = told.values
                self.generation = told.generation


def test_who_joins_is_told_the_status_and_the_mission_first_and_one_of_each() -> None:
    snapshot = Snapshot()
    for seq in (1, 2):
        snapshot.accept(heard(Topic.ODOMETRY, "odometry", seq), 0)
        snapshot.accept(heard(Topic.SWEEP, "range_measured", seq), 0)
    snapshot.accept(whole(0, EMPTY), 0)
    snapshot.accept(
        heard(Topic.MISSION, "mission_progress", 3, mission_id=1, kind="drive", phase="driving", stop=0, stops=1), 0
    )
    assert [read(frame).event for frame in snapshot.frames()] == ["mission_progress", "odometry", "map_changed"]
    snapshot.accept(heard(Topic.ODOMETRY, "odometry", 1, session="another"), 0)
    assert [read(frame).event for frame in snapshot.frames()] == ["odometry"]
    assert snapshot.mission is None


def test_changes_of_a_map_follow_on_each_other_or_are_asked_for() -> None:
    kept = MapKept()
    assert not kept.accept(change(1, 0, 1))
    assert kept.accept(whole(3, EMPTY))
    assert kept.accept(change(3, 0, 1)), "the whole has it"
    assert kept.accept(change(4, 0, 1))
    assert not kept.accept(change(6, 0, 1))
    assert len(kept.frames) == 2


@given(st.lists(st.tuples(st.integers(0, ROWS * COLS - 1), st.integers(0, 255)), max_size=120), st.integers(0, 120))
def test_a_folded_map_is_the_map_with_its_changes_laid_in_one_by_one(cells: list[tuple[int, int]], cut: int) -> None:
    kept, slow = MapKept(), Page()
    kept.accept(whole(0, EMPTY))
    slow.take([whole(0, EMPTY).data])
    for generation, (cell, value) in enumerate(cells, 1):
        kept.accept(change(generation, cell, value))
        slow.take([change(generation, cell, value).data])
        if generation == cut and (parts := kept.parts()) is not None:
            kept.replace(folded(*parts))
    fast = Page()
    fast.take(kept.frames)
    assert fast.generation == slow.generation
    assert fast.cells is not None
    assert slow.cells is not None
    assert np.array_equal(fast.cells, slow.cells)


def outbox_of(kept: MapKept) -> PageOutbox:
    return PageOutbox(lambda: kept.frames)


@given(st.lists(st.one_of(st.integers(1, 70), st.just(0)), max_size=12))
def test_a_browser_that_reads_when_it_likes_ends_with_the_daemons_map(steps: list[int]) -> None:
    kept, page = MapKept(), Page()
    box = outbox_of(kept)
    generation = 0
    first = whole(0, EMPTY)
    kept.accept(first)
    box.put(first)
    for step in steps:
        for _ in range(step):
            generation += 1
            one = change(generation, generation % (ROWS * COLS), generation % 256)
            kept.accept(one)
            box.put(one)
        if step == 0:
            while isinstance(item := box.take(), bytes):
                page.take([item])
    while isinstance(item := box.take(), bytes):
        page.take([item])
    truth = Page()
    truth.take(kept.frames)
    assert page.generation == generation == truth.generation
    assert page.cells is not None
    assert truth.cells is not None
    assert np.array_equal(page.cells, truth.cells)


def test_of_most_only_the_newest_waits_and_status_goes_first() -> None:
    box = outbox_of(MapKept())
    for seq in range(100):
        box.put(heard(Topic.ODOMETRY, "odometry", seq))
        box.put(heard(Topic.STATUS, "status", seq))
    box.say("text")
    box.ask("question")
    assert (box.take(), box.take()) == ("question", "text")
    assert [read(frame).event for frame in (box.take(), box.take()) if isinstance(frame, bytes)] == [
        "status",
        "odometry",
    ]
    assert box.take() is None
    assert not box
    assert box.dropped == 198


def test_lines_of_the_log_are_left_out_beyond_a_bound_and_that_is_told() -> None:
    box = outbox_of(MapKept())
    for seq in range(MOST_LINES + 20):
        box.put(heard(Topic.LOG, "log", seq))
    assert box.take() == {"log": 20}
    first = box.take()
    assert isinstance(first, bytes)
    assert read(first).seq == 20


def test_many_changes_of_the_map_become_one_whole_map() -> None:
    kept = MapKept()
    kept.accept(whole(0, EMPTY))
    box = outbox_of(kept)
    for generation in range(1, MOST_CHANGES + 10):
        one = change(generation, 0, generation % 256)
        kept.accept(one)
        box.put(one)
    taken = []
    while (item := box.take()) is not None:
        taken.append(item)
    assert taken == kept.frames


def test_who_reads_nothing_is_full_after_a_bound() -> None:
    box = outbox_of(MapKept())
    line = heard(Topic.LOG, "log", 1, message="x" * 100_000)
    for _ in range(MOST_BYTES // len(line.data)):
        box.put(line)
    with pytest.raises(Full):
        box.put(line)
    texts = outbox_of(MapKept())
    for _ in range(MOST_TEXTS):
        texts.say("text")
    with pytest.raises(Full):
        texts.say("text")


class Ear:
    def __init__(self) -> None:
        self.heard: list[HeardFrame] = []
        self.missed: list[tuple[str, int]] = []

    def hear(self, heard: HeardFrame) -> None:
        self.heard.append(heard)

    def lost(self, topic: str, count: int) -> None:
        self.missed.append((topic, count))


async def test_after_a_gap_the_whole_map_is_asked_for_and_told_to_all() -> None:
    asked = []

    async def ask() -> MapChanged:
        asked.append(1)
        return whole_map(5)

    fan, ear = FanOut(Snapshot(), ask), Ear()
    fan.join(ear)

    keeping = asyncio.create_task(fan.keep_map())
    try:
        fan.accept(whole(0, EMPTY, seq=1))
        fan.accept(change(2, 0, 1, seq=3))
        await asyncio.sleep(0.1)
    finally:
        keeping.cancel()
        await asyncio.wait((keeping,))
    assert asked == [1]
    assert ear.heard[-1].fields["whole"]
    assert [read(frame).fields["generation"] for frame in fan.snapshot.map.frames] == [5]


async def test_what_cannot_be_read_is_left_out_and_a_broken_subscription_begins_anew() -> None:
    async def ask() -> MapChanged:
        raise AssertionError("there is no gap")

    async def frames() -> AsyncGenerator[Frame | Gap, None]:
        yield Frame.of(message(Topic.STATUS, "status", 1, mode=7))
        yield Gap("log", 3)
        yield Gap("pose", None)
        yield Frame.of(message(Topic.ODOMETRY, "odometry", 1))
        raise RemoteProtocolError("the server speaks version 2")

    fan, ear = FanOut(Snapshot(), ask), Ear()
    fan.join(ear)
    following = asyncio.create_task(fan.follow(frames))
    await asyncio.sleep(1.5)
    following.cancel()
    await asyncio.wait((following,))
    assert [item.event for item in ear.heard] == ["odometry", "odometry"]
    assert ear.missed == [("log", 3), ("log", 3)]
