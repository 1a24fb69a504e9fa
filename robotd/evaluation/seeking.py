"""Seek one scan on a map, by the same localizer as the daemon's: the work that a schedule hands out.

A job and its queries can be pickled. A job brings what its map is made of, not the map: each process makes it once.
"""

import hashlib
import time
from dataclasses import dataclass, replace

from robotd.core.errors import RecordingError
from robotd.evaluation.degrade import Degraded
from robotd.evaluation.division import Query
from robotd.evaluation.last_made import LastMade
from robotd.evaluation.map_facts import MapFacts
from robotd.evaluation.map_recipe import MapRecipe
from robotd.evaluation.recorded import Reach, readings_of
from robotd.evaluation.result import CaseKey, CaseResult
from robotd.grid.occupancy import OccupancyGrid
from robotd.localization.at_stop import estimator_at_stop
from robotd.localization.judge.error_model import ErrorModel
from robotd.localization.judge.judgement import Judgement
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings


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
    """All cases of one log, asked in one way: a query in, a result out."""

    log: str
    protocol: str
    recipe: MapRecipe
    settings: SeekingSettings
    seed: int
    commit: str
    digest: str
    """Of settings and map."""

    @classmethod
    def of(
        cls, log: str, recipe: MapRecipe, settings: SeekingSettings, *, seed: int, commit: str, protocol: str
    ) -> "Seeking":
        """Return the job of a log."""
        # How many threads share the work changes no answer.
        told = f"{settings.reach} {settings.localization} {settings.judgement} {settings.error_model} {recipe.digest()}"
        digest = hashlib.sha256(told.encode()).hexdigest()[:16]
        return cls(log, protocol, recipe, settings, seed, commit, digest)

    @property
    def grid(self) -> OccupancyGrid:
        """The map, as it is after what is done to it."""
        return self._made.map.grid

    @property
    def facts(self) -> MapFacts:
        """What is told of the map."""
        return self._made.facts

    def __call__(self, query: Query) -> CaseResult:
        """Seek a scan, nothing known.

        Raises:
            RecordingError: the log makes no map.
        """
        # The truth moves with the map: a map that is turned or scaled has its places elsewhere.
        query = replace(query, truth=query.truth and self._made.map.pose(query.truth))
        ready_map, settings = self._ready_map, self.settings
        readings = readings_of(query.scan, settings.reach)
        # Both: what compares versions on a busy machine, and what a robot would wait.
        cpu_s, wall_s = time.process_time(), time.perf_counter()
        headings_rad = settings.localization.headings_all_round()
        estimator = estimator_at_stop(
            ready_map, "", headings_rad, judgement=settings.judgement, threads=settings.threads
        )
        estimator.add(*readings)
        estimate = estimator.estimate(0, final=True)
        cpu_s, wall_s = time.process_time() - cpu_s, time.perf_counter() - wall_s
        return CaseResult.of(self.key_of(query), query, estimate, cpu_s=cpu_s, wall_s=wall_s)

    def key_of(self, query: Query) -> CaseKey:
        """Return by what the result of a query is known."""
        return CaseKey(self.log, query.number, self.seed, self.digest, self.commit, self.protocol)

    @property
    def _made(self) -> "_Made":
        return _made.of(self.digest, self._make)

    @property
    def _ready_map(self) -> ReadyMap:
        settings = self.settings
        return _ready.of(self.digest, lambda: ReadyMap.of(self.grid, settings.localization, settings.error_model))

    def _make(self) -> "_Made":
        try:
            made = self.recipe.made()
        except ValueError as error:
            raise RecordingError(f"{self.log}: no map can be made of it: {error}") from error
        return _Made(made, MapFacts.of(made.grid))


@dataclass(frozen=True, slots=True, eq=False)
class _Made:
    map: Degraded
    facts: MapFacts


_made: LastMade[_Made] = LastMade()
_ready: LastMade[ReadyMap] = LastMade()
"""Apart from the map itself: who only draws it needs no ready one."""
