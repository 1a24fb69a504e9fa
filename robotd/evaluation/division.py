"""Which scans of a log make the map, and at which the robot is sought.

Scans in file order, of more than 2000 only every fourth. The even ones make the map. Each case is one of the odd
ones, chosen by a seeded generator; nothing is known beforehand. Figures of programs that keep to this compare.
"""

from dataclasses import dataclass

import numpy as np

from robotd.logs.scan import RecordedLog, Scan

_MANY_SCANS = 2000
_OF_MANY_EVERY = 4


@dataclass(frozen=True, slots=True, eq=False)
class Query:
    """A scan to be found on the map."""

    number: int
    """Which scan of the log it is, in file order, from 0."""
    scan: Scan


@dataclass(frozen=True, slots=True, eq=False)
class Division:
    """A log, divided."""

    map_scans: tuple[Scan, ...]
    queries: tuple[Query, ...]


def divide(log: RecordedLog, cases: int, seed: int) -> Division:
    """Divide a log into the scans of the map and at most ``cases`` queries, in the order in which they are drawn."""
    numbered = tuple(Query(number, scan) for number, scan in enumerate(log.scans))
    if len(numbered) > _MANY_SCANS:
        numbered = numbered[::_OF_MANY_EVERY]
    odd = numbered[1::2]
    chosen = np.random.default_rng(seed).choice(len(odd), min(cases, len(odd)), replace=False) if odd else ()
    return Division(tuple(query.scan for query in numbered[::2]), tuple(odd[index] for index in chosen))
