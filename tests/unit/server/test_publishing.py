"""What is thinned out, what is kept, and what becomes of maps that come too fast."""

import asyncio
import logging
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import Event, MapChanged, MissionPhase, MissionProgress, StopPlaced, SweepProgress
from robotd.contract.topics import LogEntry
from robotd.core.broadcast import Broadcast
from robotd.core.pose import IDENTITY, STANDSTILL, Odometry
from robotd.front.decimation import Decimator
from robotd.front.log_relay import relay_log
from robotd.front.outcomes import Outcomes
from robotd.server.map_queue import MapQueue
from robotd.server.replies import Replies

MS = 1_000_000


def odometry(time_ns: int) -> Odometry:
    return Odometry(time_ns, IDENTITY, STANDSTILL)


def test_odometry_is_thinned_to_the_rate() -> None:
    decimator = Decimator(20.0)
    passed = [time_ns for time_ns in range(0, 1000 * MS, 10 * MS) if decimator.passes(odometry(time_ns))]
    assert passed == list(range(0, 1000 * MS, 50 * MS))


@pytest.mark.parametrize("period_ms", [10, 20, 33, 40, 49, 50, 70])
def test_the_rate_is_kept_in_the_mean_whatever_the_period_of_what_comes(period_ms: int) -> None:
    decimator = Decimator(20.0)
    times_ms = range(0, 10_000, period_ms)
    passed = [at_ms for at_ms in times_ms if decimator.passes(odometry(at_ms * MS))]
    assert len(passed) == pytest.approx(min(len(times_ms), 200), rel=0.03)
    # Never two at once to make up for a silence.
    assert min(after - before for before, after in pairwise(passed)) >= min(period_ms, 50) // period_ms * period_ms


def test_what_comes_after_a_silence_is_not_made_up_for() -> None:
    decimator = Decimator(20.0)
    times_ms = [0, *range(5000, 5100, 10)]
    assert [at_ms for at_ms in times_ms if decimator.passes(odometry(at_ms * MS))] == [0, 5000, 5050]


def test_time_that_steps_back_starts_anew() -> None:
    decimator = Decimator(20.0)
    assert [decimator.passes(odometry(time_ns)) for time_ns in (900 * MS, 0, 10 * MS)] == [True, True, False]


def test_the_last_reading_of_a_sweep_is_never_thinned_out() -> None:
    decimator = Decimator(20.0)
    passed = [taken for taken in range(1, 301) if decimator.passes(SweepProgress(taken * MS, 0, taken, 300, 0, 0, 0))]
    assert passed[-1] == 300
    assert len(passed) == 7


def test_estimates_are_thinned_only_while_they_are_predicted(make_estimate: Callable[..., PoseEstimate]) -> None:
    decimator = Decimator(20.0)
    for state in PoseState:
        passed = [decimator.passes(make_estimate(state, time_ns)) for time_ns in (1, 2, 3)]
        assert passed == ([True, False, False] if state is PoseState.PREDICTED else [True, True, True])


def change(generation: int, make_map: Callable[..., MapChanged]) -> MapChanged:
    part = {"whole": False, "cells": np.array([1], dtype=np.intp), "values": np.array([2], dtype=np.uint8)}
    return replace(make_map(generation), **part)  # type: ignore[arg-type]  # mypy cannot see through the dict


async def test_changes_of_a_map_leave_in_order(make_map: Callable[..., MapChanged]) -> None:
    queue = MapQueue()
    changes = [change(generation, make_map) for generation in range(3)]
    for item in changes:
        queue.put(item)
    assert [await queue.get() for _ in range(3)] == changes


async def test_too_many_changes_become_one_whole_map(make_map: Callable[..., MapChanged]) -> None:
    queue = MapQueue()
    for generation in range(100):
        queue.put(change(generation, make_map))
    assert await queue.get() is None
    waiting = asyncio.create_task(queue.get())
    await asyncio.sleep(0)
    later = change(100, make_map)
    queue.put(later)
    assert await waiting is later


def placed(stop: int) -> StopPlaced:
    return StopPlaced(7, "m", stop, "placed", IDENTITY, 0.0, 0.0, 1.0, 0.0)


async def test_what_is_told_of_stops_leaves_in_its_place_and_is_not_lost_with_the_changes(
    make_map: Callable[..., MapChanged],
) -> None:
    queue = MapQueue()
    events: list[Event] = [placed(0), change(1, make_map), placed(1), change(2, make_map)]
    for event in events:
        queue.put(event)
    assert [await queue.get() for _ in range(4)] == events
    for event in events:
        queue.put(event)
    queue.ask_for_whole()
    assert [await queue.get() for _ in range(3)] == [None, placed(0), placed(1)]


async def test_of_too_many_stops_the_latest_are_told(make_map: Callable[..., MapChanged]) -> None:
    queue = MapQueue()
    for stop in range(100):
        queue.put(placed(stop))
    queue.put(change(1, make_map))
    assert [await queue.get() for _ in range(64)] == [placed(stop) for stop in range(36, 100)]


async def test_a_whole_map_replaces_what_waits(make_map: Callable[..., MapChanged]) -> None:
    queue = MapQueue()
    whole = make_map(2)
    queue.put(change(1, make_map))
    queue.put(whole)
    assert await queue.get() is whole


async def test_the_outcome_of_a_mission_is_remembered() -> None:
    events: Broadcast[Event] = Broadcast()
    outcomes = Outcomes()
    task = asyncio.create_task(outcomes.follow(events))
    await asyncio.sleep(0)
    for mission_id in range(1, 31):
        for phase in (MissionPhase.STARTED, MissionPhase.DONE):
            events.publish(MissionProgress(1, mission_id, "map", phase, 0, 1))
    await asyncio.sleep(0)
    latest = outcomes.latest(30)
    assert latest is not None
    assert latest.phase is MissionPhase.DONE
    assert outcomes.latest(1) is None
    task.cancel()


def test_replies_are_forgotten_oldest_first() -> None:
    replies = Replies(2)
    for number in range(3):
        replies.begin((b"a", number))
        assert replies.is_under_way((b"a", number))
        replies.end((b"a", number), b"%d" % number)
    assert [replies.given((b"a", number)) for number in range(3)] == [None, b"1", b"2"]
    assert replies.given((b"b", 1)) is None


async def test_the_log_is_relayed_from_any_thread() -> None:
    lines: list[LogEntry] = []
    logger = logging.getLogger("robotd.somewhere")
    logger.setLevel(logging.INFO)
    with relay_log(lines.append):
        logger.info("number %d", 1)
        logger.debug("unheard")
        await asyncio.get_running_loop().run_in_executor(None, logger.warning, "x" * 9000)
        await asyncio.sleep(0.01)
    logger.info("too late")
    await asyncio.sleep(0.01)
    assert [(line.level, line.logger, line.message[:10]) for line in lines] == [
        ("INFO", "robotd.somewhere", "number 1"),
        ("WARNING", "robotd.somewhere", "x" * 10),
    ]
    assert len(lines[1].message) == 2000
