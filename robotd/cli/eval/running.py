"""Seek scan after scan on one map, by the same localizer as the daemon's."""

import time
from collections.abc import Iterator
from dataclasses import dataclass

from robotd.cli.eval.cases import Query
from robotd.cli.eval.recorded import Reach, readings_of
from robotd.cli.eval.verdict import Case
from robotd.grid.binary import BinaryMap
from robotd.grid.occupancy import OccupancyGrid
from robotd.localization.localizer import LocalizationSettings, Localizer


@dataclass(frozen=True, slots=True)
class Searcher:
    """What all cases of a log share."""

    grid: OccupancyGrid
    settings: LocalizationSettings
    reach: Reach
    threads: int

    def cases(self, queries: tuple[Query, ...]) -> Iterator[Case]:
        """Seek each query, nothing known, and hand it over as soon as it is answered."""
        localizer = Localizer(BinaryMap.from_grid(self.grid), self.settings, "", threads=self.threads)
        headings_rad = self.settings.headings_all_round()
        for query in queries:
            readings = readings_of(query.scan, self.reach)
            cpu_s, wall_s = time.process_time(), time.perf_counter()
            localizer.begin(headings_rad)
            localizer.add(*readings)
            estimate = localizer.estimate(0, final=True)
            yield Case(query, estimate, time.process_time() - cpu_s, time.perf_counter() - wall_s)
