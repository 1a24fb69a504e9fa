"""What the world is told of a sweep under way."""

import itertools

from robotd.contract.events import Event, SweepBegun, SweepProgress, SweepReadings
from robotd.contract.sweep_columns import from_columns
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.mission.missions.sweep_told import SweepTold

MS = 1_000_000
IN_ODOM, IN_MAP = Pose2(1.0, 2.0, 0.5), Pose2(4.0, 3.0, -0.5)
STATUSES = (ReadingStatus.OK, ReadingStatus.MISS, ReadingStatus.WEAK, ReadingStatus.TIMEOUT)


def reading(number: int, apart_ms: int) -> RangeReading:
    status = STATUSES[number % 4]
    range_m = 1.0 if status in {ReadingStatus.OK, ReadingStatus.MISS} else None
    return RangeReading(number * apart_ms * MS, number / 64.0, status, range_m)


def told_of(readings: int, apart_ms: int) -> list[Event]:
    said: list[Event] = []
    told = SweepTold(3, readings, said.append, lambda in_odom: IN_MAP if in_odom == IN_ODOM else None)
    told.begun(IN_ODOM)
    for number in range(readings):
        told.read(reading(number, apart_ms))
    return said


async def test_every_tenth_reading_and_the_last_are_counted_by_kind() -> None:
    counts = [
        (e.number, e.taken, e.total, e.hits, e.misses, e.rejected)
        for e in told_of(24, 30)
        if isinstance(e, SweepProgress)
    ]
    assert counts == [(3, 10, 24, 3, 3, 4), (3, 20, 24, 5, 5, 10), (3, 24, 24, 6, 6, 12)]


async def test_it_begins_where_the_robot_stands_by_odometry_and_on_the_map() -> None:
    begun = told_of(4, 30)[0]
    assert isinstance(begun, SweepBegun)
    assert (begun.number, begun.total, begun.in_odom, begun.in_map) == (3, 4, IN_ODOM, IN_MAP)


async def test_all_readings_are_told_once_in_order_and_at_most_twenty_times_a_second() -> None:
    for apart_ms in (1, 7, 30, 200):
        columns = [event for event in told_of(301, apart_ms) if isinstance(event, SweepReadings)]
        assert [event.first for event in columns] == [
            sum(len(before.status_u8) for before in columns[:at]) for at in range(len(columns))
        ]
        heard = [reading for event in columns for reading in from_columns(event)]
        assert [(one.bearing_rad, one.status) for one in heard] == [
            (one.bearing_rad, one.status) for one in (reading(number, apart_ms) for number in range(301))
        ]
        apart = [after.time_ns - before.time_ns for before, after in itertools.pairwise(columns)]
        assert min(apart[:-1]) >= 50 * MS  # the last readings of a sweep wait for nothing
