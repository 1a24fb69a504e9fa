"""How time and the size of arrangements grow with edges and readings, beside what the paper's theorems promise."""

import math
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

from robotd.exact.arrangement import Arrangement, at_least
from robotd.exact.beams import Beam
from robotd.exact.feasible import (
    PolygonMap,
    best_rank,
    feasible_arrangement,
    feasible_poses,
    is_feasible,
    ranked,
)
from robotd.exact.planar import PlanarSet
from robotd.exact.polygons import edge_count
from robotd.exact.rationals import ARITHMETICS, rational
from robotd.exact.regions import regions
from robotd.exact.sweep import arrange
from tests.studies.exact.operations import counted
from tests.studies.exact.scenes import (
    crossed_bars,
    crossed_bars_and_readings,
    halving_readings,
    laboratory,
    readings,
    scattered,
)

STEP_M = rational("0.01")
"""What ranges are rounded to when there is an error radius."""
EDGES = (20, 50, 100, 200, 400)
READINGS = (1, 4, 16, 64)
_LONG_S = 2.0
"""What takes longer is not run again for the sake of the clock."""


@dataclass(frozen=True, slots=True)
class Localized:
    """One localization with everything that is said of it."""

    eps: str
    readings: int
    best_rank: int
    regions: int
    area_m2: float
    vertices: int
    seconds: float


@dataclass(frozen=True, slots=True)
class Growth:
    """One size of input: how large its arrangements are, and what they cost."""

    edges: int
    """n."""
    readings: int
    """m."""
    eps: str
    borders: int
    """N, what the sweeps are given: a few for each edge and reading."""
    crossings: int
    """s, the points where borders of several sets meet or cross."""
    predicates: int
    seconds: float
    overlay: bool

    @property
    def promise(self) -> float:
        """What the paper's theorem says, without its factor: 3 and 4 for one reading, 5 and 7 for an overlay."""
        n, m, s = self.edges, self.readings, self.crossings
        return (m * n * n + s) * math.log2(m * n) if self.overlay else (n + s) * math.log2(n)

    @property
    def work(self) -> float:
        """``(N + s) log N``, for one sweep over everything: the sharper bound."""
        return (self.borders + self.crossings) * math.log2(self.borders)


Result = TypeVar("Result")


def timed(work: Callable[[], Result]) -> tuple[Result, float]:
    """Return what work returns, and what time of the processor it took, the least of two short runs."""
    result, seconds = _once(work)
    return (result, seconds) if seconds > _LONG_S else (result, min(seconds, _once(work)[1]))


def _once(work: Callable[[], Result]) -> tuple[Result, float]:
    start = time.process_time()
    result = work()
    return result, time.process_time() - start


def in_the_laboratory() -> Iterator[Localized]:
    """Yield 24 readings in the laboratory: exact ones without an error radius, rounded ones with one."""
    walls, pose = laboratory()
    for eps, step in (("0", None), ("0.02", STEP_M), ("0.1", STEP_M)):
        yield _localized(walls, readings(walls, pose, 24, step_m=step), eps)


def by_arithmetic() -> Iterator[tuple[str, float, float]]:
    """Yield each arithmetic that is installed, and how long 24 readings take with it, without and with a radius."""
    for name, arithmetic in ARITHMETICS.items():
        walls, pose = laboratory(arithmetic)
        beams = readings(walls, pose, 24, step_m=rational(STEP_M, arithmetic))
        without, within = (PolygonMap(walls, rational(eps, arithmetic)) for eps in ("0", "0.1"))
        yield name, timed(partial(ranked, without, beams))[1], timed(partial(ranked, within, beams))[1]


def _localized(walls: PlanarSet, beams: Sequence[Beam], eps: str) -> Localized:
    ranks, seconds = timed(lambda: ranked(PolygonMap(walls, rational(eps)), beams))
    best = best_rank(ranks)
    found = regions(ranks, at_least(best))
    area = sum(region.area_m2 for region in found)
    return Localized(eps, len(beams), best, len(found), area, len(ranks.vertices), seconds)


def with_edges(eps: str) -> Iterator[Growth]:
    """Yield theorems 3 and 4: one reading on maps of more and more edges, the mean of four directions."""
    for edges in EDGES:
        walls, pose = scattered(edges, seed=edges)
        beams = readings(walls, pose, 4, step_m=STEP_M)
        polygon_map = PolygonMap(walls, rational(eps))
        single = [grown_by(polygon_map, [beam], eps, overlay=False) for beam in beams]
        borders, crossings, predicates = (
            round(statistics.mean(sizes))
            for sizes in zip(*((one.borders, one.crossings, one.predicates) for one in single), strict=True)
        )
        seconds = statistics.mean(one.seconds for one in single)
        yield Growth(single[0].edges, 1, eps, borders, crossings, predicates, seconds, overlay=False)


def with_readings(edges: int, eps: str) -> Iterator[Growth]:
    """Yield theorems 5 and 7: more and more readings on one map, both steps together."""
    walls, pose = scattered(edges, seed=edges)
    polygon_map = PolygonMap(walls, rational(eps))
    for count in READINGS:
        yield grown_by(polygon_map, readings(walls, pose, count, step_m=STEP_M), eps, overlay=True)


def grown_by(polygon_map: PolygonMap, beams: Sequence[Beam], eps: str, *, overlay: bool) -> Growth:
    """Measure a localization: its sweeps one by one, and then, for an overlay, the one over what they found."""

    def work() -> list[Arrangement]:
        singles = [feasible_arrangement(polygon_map, beam) for beam in beams]
        return [*singles, arrange([one.select(is_feasible) for one in singles])] if overlay else singles

    borders = sum(_borders(polygon_map, beam) for beam in beams)
    with counted() as operations:
        work()
    found, seconds = timed(work)
    crossings = sum(map(crossings_of, found))
    n = edge_count(polygon_map.obstacles)
    return Growth(n, len(beams), eps, borders, crossings, operations.all_of_them, seconds, overlay=overlay)


def crossings_of(arrangement: Arrangement) -> int:
    """Return s: how many vertices are more than a corner or an end of one border."""
    return sum(len(vertex.into) + len(vertex.out) > 2 for vertex in arrangement.vertices)


def _borders(polygon_map: PolygonMap, beam: Beam) -> int:
    parts = [polygon_map.endpoint_set(beam), *polygon_map.blocked_parts(beam)]
    return sum(len(part.borders) for part in parts)


def lemma_2_pieces() -> Iterator[tuple[int, int, float]]:
    """Yield n, the pieces of FP(M, z) on fig. 12, and pieces / n^2."""
    for bars in (1, 2, 4, 8, 16):
        walls, beam = crossed_bars(bars)
        pieces = len(regions(feasible_arrangement(PolygonMap(walls, rational(0)), beam), is_feasible))
        yield 8 * bars, pieces, pieces / (8 * bars) ** 2


def lemma_2_crossings() -> Iterator[tuple[int, int, float]]:
    """Yield m, the points where FP(M, z) of two of fig. 13's readings cross, and crossings / m^2."""
    for count in (2, 4, 8, 16, 32):
        walls, beams = halving_readings(count)
        overlay = ranked(PolygonMap(walls, rational(0)), beams)
        crossings = sum(len(vertex.into) == len(vertex.out) == 2 for vertex in overlay.vertices)
        yield count, crossings, crossings / count**2


def lemma_2() -> Iterator[tuple[int, int, int, float, int, float]]:
    """Yield n, m, the borders of all FP(M, z) and those over m n^2, their crossings and those over (m n)^2."""
    for bars, count in ((2, 2), (2, 4), (2, 8), (4, 8), (8, 8), (8, 16)):
        walls, beams = crossed_bars_and_readings(bars, count)
        polygon_map = PolygonMap(walls, rational(0))
        sets = [feasible_poses(polygon_map, beam) for beam in beams]
        borders, n = sum(len(one.borders) for one in sets), 8 * bars
        crossings = sum(len(vertex.into) == len(vertex.out) == 2 for vertex in arrange(sets).vertices)
        yield n, count, borders, borders / (count * n**2), crossings, crossings / (count * n) ** 2
