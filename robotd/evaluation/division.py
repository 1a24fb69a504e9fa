"""Which scans of a log make the map, and at which the robot is sought: one protocol each, so that figures compare.

Scans in file order, of more than 2000 only every fourth.

- *interleaved*: the even ones make the map, each case is one of the odd ones. The robot is never far off the map.
- *half*: the first half makes the map, each case is one of the second half. Many are well off the map.
- *other*: the even ones of another building make the map. No place is right, and sure means wrong.

Cases are chosen by a seeded generator; nothing is known beforehand.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from robotd.core.angles import wrap_rad
from robotd.core.pose import Pose2
from robotd.logs.scan import RecordedLog, Scan

_MANY_SCANS = 2000
_OF_MANY_EVERY = 4
_NEAR_M = 1.0
_NEAR_RAD = math.radians(45.0)
"""As near to a scan of the map, a query is on the map: most of what it sees was seen from there."""


@dataclass(frozen=True, slots=True, eq=False)
class Query:
    """A scan to be found on the map."""

    number: int
    """Which scan of the log it is, in file order, from 0."""
    scan: Scan
    truth: Pose2 | None
    """Where the laser was on the map; None if that is another building's."""
    is_near: bool
    """Whether a scan of the map was taken within 1 m and 45 degrees of it."""


@dataclass(frozen=True, slots=True, eq=False)
class Division:
    """What makes the map, and what is asked of it."""

    map_scans: tuple[Scan, ...]
    queries: tuple[Query, ...]
    """In the order in which they were drawn."""


@dataclass(frozen=True, slots=True)
class Cut:
    """Which scans of a log make the map, and which are left to ask, by their numbers."""

    for_map: range
    to_ask: range

    @classmethod
    def interleaved(cls, scans: int) -> "Cut":
        """Cut a log into even scans and odd ones."""
        numbers = _numbers(scans)
        return cls(numbers[::2], numbers[1::2])

    @classmethod
    def halves(cls, scans: int) -> "Cut":
        """Cut a log in the middle."""
        numbers = _numbers(scans)
        middle = (len(numbers) + 1) // 2
        return cls(numbers[:middle], numbers[middle:])


def interleaved(log: RecordedLog, cases: int, seed: int) -> Division:
    """Divide a log: even scans make the map, at most ``cases`` of the odd ones are asked."""
    return _division(log, Cut.interleaved(len(log.scans)), cases, seed)


def halves(log: RecordedLog, cases: int, seed: int) -> Division:
    """Divide a log: its first half makes the map, at most ``cases`` of the second are asked."""
    return _division(log, Cut.halves(len(log.scans)), cases, seed)


def elsewhere(log: RecordedLog, building: RecordedLog, cases: int, seed: int) -> Division:
    """Ask at most ``cases`` of the odd scans of a log of the map that another building's even ones make."""
    chosen = _chosen(Cut.interleaved(len(log.scans)).to_ask, cases, seed)
    queries = tuple(Query(number, log.scans[number], None, is_near=False) for number in chosen)
    return Division(_scans(building, Cut.interleaved(len(building.scans)).for_map), queries)


def _numbers(scans: int) -> range:
    # In a long log neighbours are all but alike: a map of every fourth is as good, and made in a quarter of the time.
    return range(0, scans, _OF_MANY_EVERY if scans > _MANY_SCANS else 1)


def _scans(log: RecordedLog, numbers: Iterable[int]) -> tuple[Scan, ...]:
    return tuple(log.scans[number] for number in numbers)


def _chosen(numbers: range, cases: int, seed: int) -> Sequence[int]:
    if not numbers:
        return ()
    order = np.random.default_rng(seed).choice(len(numbers), min(cases, len(numbers)), replace=False)
    return [numbers[index] for index in order]


def _division(log: RecordedLog, cut: Cut, cases: int, seed: int) -> Division:
    map_scans = _scans(log, cut.for_map)
    known = [scan.laser_pose for scan in map_scans]
    queries = (
        Query(number, scan, scan.laser_pose, is_near=_is_near(scan.laser_pose, known))
        for number in _chosen(cut.to_ask, cases, seed)
        for scan in (log.scans[number],)
    )
    return Division(map_scans, tuple(queries))


def _is_near(pose: Pose2, known: Sequence[Pose2]) -> bool:
    return any(
        pose.distance_m(other) <= _NEAR_M and abs(wrap_rad(pose.heading_rad - other.heading_rad)) <= _NEAR_RAD
        for other in known
    )
