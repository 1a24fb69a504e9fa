"""Jobs and answers come back from bytes as they were, and what is none is refused by name."""

import math
from hashlib import sha256
from typing import Any, get_origin

import numpy as np
import pytest

from robotd.contract.area import Area
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.ways import Way
from robotd.core.errors import MapError, RemoteProtocolError
from robotd.core.grid_bytes import packed_cells, unpacked_cells
from robotd.core.motion_error import Travel
from robotd.core.pose import IDENTITY, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.core.rectangle import Rectangle
from robotd.exploring.settings import Pace
from robotd.exploring.tried import Tried
from robotd.grid.settings import GridSettings
from robotd.head.answering import answer_to
from robotd.head.desk import Desk
from robotd.head.job import Done, Job
from robotd.head.job_names import JOBS
from robotd.head.job_table import perform
from robotd.head.jobs import (
    BeginMap,
    Choose,
    ChooseBearings,
    ChooseSafeWay,
    Forget,
    Glance,
    Insert,
    Inserted,
    MakeFiles,
    MapRef,
    Narrow,
    PlaceStop,
    Plan,
    Prepare,
    PreviewWay,
    ReadMap,
    ShowMap,
    ShowRanks,
    TakeMap,
    TakeReadings,
)
from robotd.head.parts_jobs import TakePart
from robotd.head.settings import HeadSettings
from robotd.head.wire import JobFailed, pack_answer, pack_error, pack_job, unpack_answer, unpack_job
from robotd.sensing.rivals import Rival

GRID = GridSettings(rows=60, cols=80)
SPEC = GRID.spec_covering(((0.0, 0.0),), 1.0)
HERE = Pose2(0.1, -0.2, 0.3)
READINGS = tuple(
    RangeReading(7 + n, 0.1 * n, ReadingStatus.MISS if n % 7 == 0 else ReadingStatus.OK, 1.0 + 0.2 * math.sin(n), n)
    for n in range(60)
)
SWEEP = Sweep(3, IDENTITY, (*READINGS, RangeReading(99, 6.1, ReadingStatus.WEAK, None)))


def a_life() -> list[Job[Any]]:
    """Every kind of job, in an order in which they can be done."""
    desk = Desk(HeadSettings())
    begin, insert, make = BeginMap(1, SPEC, GRID), Insert(MapRef(1), SWEEP, HERE), MakeFiles(MapRef(1, 1))
    perform(desk, begin)
    perform(desk, insert)
    content = perform(desk, make).content
    shown = perform(desk, ShowMap(MapRef(1, 1)))
    return [
        *(begin, insert, make, ShowMap(MapRef(1, 1)), Plan(MapRef(1, 1), HERE, (0.5, 0.5))),
        PreviewWay(MapRef(1, 1), HERE, (0.5, 0.5)),
        TakePart(SPEC, sha256(shown.packed).hexdigest(), len(shown.packed), 0, bytes(shown.packed)),
        *(ReadMap(2, content), TakeMap(3, SPEC, shown.packed, GRID, content.files["stops.bin"])),
        *(BeginMap(5, SPEC, GRID), PlaceStop(MapRef(5), "m", SWEEP, Travel(), HERE, 7)),
        PlaceStop(MapRef(5, 1), "m", SWEEP, Travel(Pose2(0.02, 0.0, 0.01), 0.02, 0.01), HERE, 8),
        Glance(MapRef(5, 2), READINGS[1:7], HERE, Travel(Pose2(0.1, 0.0, 0.0), 0.1, 0.0)),
        Choose(MapRef(1, 1), HERE, Tried(((0.2, 0.2),)), Rectangle(-1.0, -1.0, 1.0, 1.0), 3.0, Pace()),
        Prepare(4, MapRef(2), "a map", (0.1, 0.2, 0.3), Area(0.0, 0.0, 0.5), 1.0, tells_smallest_error=True),
        ChooseBearings(MapRef(1, 1), ((HERE, 0.6), (IDENTITY, 0.4)), (0.1, 0.7, 1.3), (2.0,), 2, 6.0),
        ChooseSafeWay(MapRef(1, 1), (Rival(HERE, ((0.1, -0.2),)), Rival(IDENTITY, ((0.0, 0.0), (0.1, 0.0)))), 6.0, 0.4),
        *(TakeReadings(4, READINGS[:20]), Narrow(4, READINGS[20:], 5, True)),
        *(ShowRanks(4), Forget(4), ShowRanks(4)),
    ]


def test_every_job_comes_out_of_its_bytes_as_it_was_and_so_does_its_answer() -> None:
    life = a_life()
    assert {type(job) for job in life} == set(JOBS.values())
    near, far = Desk(HeadSettings()), Desk(HeadSettings())
    for job in life:
        assert unpack_job(pack_job(job)) == job
        answer = unpack_answer(type(job), answer_to(far, pack_job(job)))
        assert answer == perform(near, job)
        assert type(answer) is (get_origin(job.answer) or job.answer)


def test_whatever_way_a_map_came_it_is_the_same_map() -> None:
    desk = Desk(HeadSettings())
    answers = {job.name: perform(desk, job) for job in a_life()}
    shown = answers["show map"]
    assert answers["insert"].digest == shown.digest == answers["read map"].digest == answers["take map"].digest
    assert (answers["insert"].stops, shown.stops, answers["take map"].stops) == (1, 1, 1)
    cells = unpacked_cells(answers["begin map"].packed, SPEC).copy()
    inserted: Inserted = answers["insert"]
    cells.reshape(-1)[np.frombuffer(inserted.cells, "<i8")] = np.frombuffer(inserted.values, np.uint8)
    assert packed_cells(cells) == shown.packed


def test_a_generation_that_nobody_took_is_made_once_more_and_the_one_before_stays_until_it_is_gone_on_from() -> None:
    desk = Desk(HeadSettings())
    begun = perform(desk, BeginMap(1, SPEC, GRID))
    first = perform(desk, Insert(MapRef(1), SWEEP, HERE))
    assert perform(desk, Insert(MapRef(1), SWEEP, HERE)) == first
    assert perform(desk, ShowMap(MapRef(1))) == begun
    assert perform(desk, ShowMap(MapRef(1, 1))).digest == first.digest
    assert "no map 1 of generation 0" in refused(desk, ShowMap(MapRef(1)))


def refused(desk: Desk, job: Job[Any]) -> str:
    with pytest.raises(RemoteProtocolError) as refusal:
        unpack_answer(type(job), answer_to(desk, pack_job(job)))
    return str(refusal.value)


def test_what_is_not_held_says_so() -> None:
    desk = Desk(HeadSettings())
    perform(desk, BeginMap(1, SPEC, GRID))
    perform(desk, Forget(1))
    assert "no map 1" in refused(desk, ShowMap(MapRef(1)))
    assert "no stop 9" in refused(desk, TakeReadings(9, READINGS))


def test_an_error_that_was_foreseen_comes_as_it_is_and_another_with_where_it_was() -> None:
    with pytest.raises(MapError, match="has a hole"):
        unpack_answer(ShowMap, pack_error(MapError("cells.bin has a hole")))
    desk = Desk(HeadSettings())
    perform(desk, BeginMap(1, SPEC, GRID))
    perform(desk, Prepare(2, MapRef(1), "", (0.0,), None))
    bad = Narrow(2, (RangeReading(1, 0.1, ReadingStatus.WEAK, None),), 5, False)
    with pytest.raises(JobFailed, match="ValueError") as failed:
        unpack_answer(Narrow, answer_to(desk, pack_job(bad)))
    assert "in perform" in failed.value.__notes__[0]


@pytest.mark.parametrize(
    "data",
    [b"", b"\xc1", b"\x90", pack_answer(Done()), pack_answer("yes"), pack_answer(7), b"\x00" * 40, pack_answer(None)],
)
def test_what_is_no_answer_is_refused(data: bytes) -> None:
    with pytest.raises((RemoteProtocolError, JobFailed)):
        unpack_answer(Plan, data)


@pytest.mark.parametrize("data", [b"", b"\xc1", pack_answer(1), pack_job(Forget(1))[:-1], b"\x92\xa4nope\x80"])
def test_what_is_no_job_is_answered_with_that(data: bytes) -> None:
    with pytest.raises(JobFailed, match="no job"):
        unpack_answer(Plan, answer_to(Desk(HeadSettings()), data))


def test_the_type_of_an_answer_is_looked_at() -> None:
    good = pack_answer(Way(((0.0, 1.0),), 1.0))
    assert unpack_answer(Plan, good) == Way(((0.0, 1.0),), 1.0)
    with pytest.raises(RemoteProtocolError, match="no answer of 'insert'"):
        unpack_answer(Insert, good)
    estimate = PoseEstimate(1, PoseState.LOST, None, (), 0, 0, True, "")
    with pytest.raises(RemoteProtocolError, match="no answer of 'plan'"):
        unpack_answer(Plan, pack_answer(estimate))
