"""Seek one scan on a map, by the same localizer as the daemon's: the piece of work that a scheduler hands out.

A scheduler has to offer ``map(job, queries)`` and nothing else: the built-in one, that of a pool of processes, that of
a cluster. So a job and its queries can be pickled, and what a job makes ready is found again by the next query in the
same process, though every batch brings a copy of its own.
"""

import hashlib
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from robotd.evaluation.division import Query
from robotd.evaluation.recorded import Reach, readings_of
from robotd.evaluation.result import CaseKey, CaseResult
from robotd.grid.occupancy import OccupancyGrid
from robotd.localization.judge.error_model import ErrorModel
from robotd.localization.judge.judgement import Judgement
from robotd.localization.localizer import Localizer
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings

Map = Callable[["Seeking", Iterable[Query]], Iterable[CaseResult]]
"""What a scheduler offers; in the order of the queries or in any other."""


@dataclass(frozen=True, slots=True)
class SeekingSettings:
    """Everything that an answer depends on but the log and its map."""

    reach: Reach
    localization: LocalizationSettings
    judgement: Judgement
    error_model: ErrorModel
    threads: int


@dataclass(frozen=True, slots=True, eq=False)
class Seeking:
    """All cases of one log: a query in, a result out."""

    log: str
    grid: OccupancyGrid
    settings: SeekingSettings
    seed: int
    commit: str
    protocol: str
    digest: str
    """Of settings and map."""

    @classmethod
    def of(
        cls, log: str, grid: OccupancyGrid, settings: SeekingSettings, *, seed: int, commit: str, protocol: str
    ) -> "Seeking":
        """Return the job of a log."""
        # How many threads share the work changes no answer.
        told = f"{settings.reach} {settings.localization} {settings.judgement} {settings.error_model} {grid.digest()}"
        return cls(log, grid, settings, seed, commit, protocol, hashlib.sha256(told.encode()).hexdigest()[:16])

    def __call__(self, query: Query) -> CaseResult:
        """Seek a scan, nothing known."""
        ready_map, settings = _ready_map_of(self), self.settings
        readings = readings_of(query.scan, settings.reach)
        # Both: what compares versions on a busy machine, and what a robot would wait.
        cpu_s, wall_s = time.process_time(), time.perf_counter()
        headings_rad = settings.localization.headings_all_round()
        localizer = Localizer.at_stop(
            ready_map, "", headings_rad, judgement=settings.judgement, threads=settings.threads
        )
        localizer.add(*readings)
        estimate = localizer.estimate(0, final=True)
        cpu_s, wall_s = time.process_time() - cpu_s, time.perf_counter() - wall_s
        return CaseResult.of(self.key_of(query), query, estimate, cpu_s=cpu_s, wall_s=wall_s)

    def key_of(self, query: Query) -> CaseKey:
        """Return by what the result of a query is known."""
        return CaseKey(self.log, query.number, self.seed, self.digest, self.commit, self.protocol)


def run(job: Seeking, queries: Iterable[Query], map_: Map = map) -> Iterator[CaseResult]:
    """Yield the results as the scheduler hands them over; nothing of them is kept."""
    yield from map_(job, queries)


_ready: dict[str, ReadyMap] = {}
"""The latest job's map by the job's digest: a map is made ready once a process, not once a batch."""


def _ready_map_of(job: Seeking) -> ReadyMap:
    if job.digest not in _ready:
        settings = job.settings
        _ready.clear()  # a process that works through a thousand logs keeps one map
        _ready[job.digest] = ReadyMap.of(job.grid, settings.localization, settings.error_model)
    return _ready[job.digest]
