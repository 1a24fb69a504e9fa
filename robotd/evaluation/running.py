"""Seek scan after scan on one map, by the same localizer as the daemon's."""

import time
from collections.abc import Iterator
from dataclasses import dataclass

from robotd.evaluation.division import Query
from robotd.evaluation.recorded import Reach, readings_of
from robotd.evaluation.verdict import Case
from robotd.grid.occupancy import OccupancyGrid
from robotd.localization.judge.error_model import ErrorModel
from robotd.localization.judge.judgement import Judgement
from robotd.localization.localizer import Localizer
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings


@dataclass(frozen=True, slots=True)
class Searcher:
    """What all cases of a log share."""

    grid: OccupancyGrid
    settings: LocalizationSettings
    judgement: Judgement
    errors: ErrorModel
    reach: Reach
    threads: int

    def cases(self, queries: tuple[Query, ...]) -> Iterator[Case]:
        """Seek each query, nothing known, and hand it over as soon as it is answered."""
        the_map = ReadyMap.of(self.grid, self.settings, self.errors)
        localizer = Localizer(the_map, "", self.judgement, threads=self.threads)
        headings_rad = self.settings.headings_all_round()
        for query in queries:
            readings = readings_of(query.scan, self.reach)
            cpu_s, wall_s = time.process_time(), time.perf_counter()
            localizer.begin(headings_rad)
            localizer.add(*readings)
            estimate = localizer.estimate(0, final=True)
            yield Case(query, estimate, time.process_time() - cpu_s, time.perf_counter() - wall_s)
