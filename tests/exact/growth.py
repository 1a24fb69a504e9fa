"""How time and the size of arrangements grow with edges and readings, beside what the paper's theorems promise."""

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

from robotd.localization.exact.arrangement import Arrangement
from robotd.localization.exact.beams import Beam
from robotd.localization.exact.feasible import PolygonMap, best_rank, feasible_arrangement, is_feasible, ranked
from robotd.localization.exact.planar import PlanarSet
from robotd.localization.exact.polygons import edge_count
from robotd.localization.exact.rationals import Rational, rational
from robotd.localization.exact.regions import of_rank, regions
from robotd.localization.exact.sweep import arrange
from tests.exact.scenes import POSE, crossed_bars, halving_readings, laboratory, readings, scattered

STEP_M = rational("0.01")
"""What ranges are rounded to when there is an error radius."""
EDGES = (20, 50, 100, 200, 400)
READINGS = (1, 2, 4, 8, 16, 32, 64)


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
    """One size of input: how large its arrangements are, and how long they took."""

    size: int
    eps: str
    borders: int
    """N, what the sweeps are given."""
    vertices: int
    """N + s, up to a factor: ends and crossings."""
    bound: float
    """What the theorem says, without its factor."""
    seconds: float

    @property
    def constant(self) -> float:
        """Seconds for each unit of ``(N + s) log N``: the same in every line if that is how time grows."""
        return self.seconds / ((self.borders + self.vertices) * math.log2(self.borders + 1))


Result = TypeVar("Result")


def timed(work: Callable[[], Result]) -> tuple[Result, float]:
    """Return what work returns, and what time of the processor it took, the least of two runs."""
    seconds = []
    for _ in range(2):
        start = time.process_time()
        result = work()
        seconds.append(time.process_time() - start)
    return result, min(seconds)


def in_the_laboratory() -> Iterator[Localized]:
    """Yield 24 readings in the laboratory: exact ones without an error radius, rounded ones with one."""
    walls = laboratory()
    for eps, step in (("0", None), ("0.02", STEP_M), ("0.1", STEP_M)):
        yield _localized(walls, readings(walls, POSE, 24, step_m=step), eps)


def _localized(walls: PlanarSet, beams: Sequence[Beam], eps: str) -> Localized:
    ranks, seconds = timed(lambda: ranked(PolygonMap(walls, rational(eps)), beams))
    best = best_rank(ranks)
    found = regions(ranks, of_rank(best))
    area = sum(region.area_m2 for region in found)
    return Localized(eps, len(beams), best, len(found), area, len(ranks.vertices), seconds)


def with_edges(eps: str) -> Iterator[Growth]:
    """Yield theorem 3 and 4: one reading on maps of more and more edges, the mean of four directions."""
    for count in EDGES:
        walls, pose = scattered(count, seed=count)
        beams = readings(walls, pose, 4, step_m=STEP_M)
        polygon_map = PolygonMap(walls, rational(eps))
        found, seconds = timed(partial(_singles, polygon_map, beams))
        n, vertices = edge_count(walls), _mean([len(one.vertices) for one in found])
        borders = _mean([_borders(polygon_map, beam) for beam in beams])
        yield Growth(n, eps, borders, vertices, (n + vertices) * math.log2(n), seconds / len(beams))


def with_readings(eps: str) -> Iterator[Growth]:
    """Yield theorems 5 and 7: more and more readings on one map, both steps together."""
    walls, pose = scattered(60, seed=60)
    polygon_map = PolygonMap(walls, rational(eps))
    n = edge_count(walls)
    for count in READINGS:
        beams = readings(walls, pose, count, step_m=STEP_M)
        (singles, overlay), seconds = timed(partial(_both_steps, polygon_map, beams))
        borders = sum(_borders(polygon_map, beam) for beam in beams)
        vertices = sum(len(single.vertices) for single in singles) + len(overlay.vertices)
        bound = (count * n**2 + len(overlay.vertices)) * math.log2(count * n)
        yield Growth(count, eps, borders, vertices, bound, seconds)


def _singles(polygon_map: PolygonMap, beams: Sequence[Beam]) -> list[Arrangement]:
    return [feasible_arrangement(polygon_map, beam) for beam in beams]


def _both_steps(polygon_map: PolygonMap, beams: Sequence[Beam]) -> tuple[list[Arrangement], Arrangement]:
    singles = _singles(polygon_map, beams)
    return singles, arrange([single.select(is_feasible) for single in singles])


def _borders(polygon_map: PolygonMap, beam: Beam) -> int:
    parts = [polygon_map.endpoint_set(beam), *polygon_map.blocked_parts(beam)]
    return sum(len(part.borders) for part in parts)


def _mean(numbers: Sequence[int]) -> int:
    return round(sum(numbers) / len(numbers))


def lemma_2_pieces() -> Iterator[tuple[int, int, float]]:
    """Yield n, the pieces of FP(M, z) on fig. 12, and pieces / n^2."""
    for bars in (1, 2, 4, 8, 16):
        walls, beam = crossed_bars(bars)
        pieces = len(regions(feasible_arrangement(PolygonMap(walls, Rational(0)), beam), is_feasible))
        yield 8 * bars, pieces, pieces / (8 * bars) ** 2


def lemma_2_crossings() -> Iterator[tuple[int, int, float]]:
    """Yield m, the points where FP(M, z) of two of fig. 13's readings cross, and crossings / m^2."""
    for count in (2, 4, 8, 16, 32):
        walls, beams = halving_readings(count)
        overlay = ranked(PolygonMap(walls, Rational(0)), beams)
        crossings = sum(len(vertex.into) == len(vertex.out) == 2 for vertex in overlay.vertices)
        yield count, crossings, crossings / count**2
