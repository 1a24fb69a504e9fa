"""Maps and readings for ``make exact``: a laboratory, scattered obstacles, and the paper's lower bounds."""

import math
import random
from pathlib import Path

from robotd.exact.beams import Beam, beam
from robotd.exact.casting import cast
from robotd.exact.formats import map_of_toml
from robotd.exact.planar import PlanarSet
from robotd.exact.points import Point
from robotd.exact.polygons import Polygon, Ring, ring_of, solid
from robotd.exact.rationals import DEFAULT, Arithmetic, Rational, rational
from robotd.exact.surds import Surd, arithmetic_of

CUT_OFF_M = 4
_FAR_M = 100


def laboratory(arithmetic: Arithmetic = DEFAULT) -> tuple[PlanarSet, Point]:
    """Return the map of ``laboratory.toml``, and where the robot really is."""
    walls = map_of_toml(Path(__file__).with_name("laboratory.toml").read_text(encoding="utf-8"), arithmetic)
    return walls, Point(rational("2.35", arithmetic), rational("5.55", arithmetic))


def readings(obstacles: PlanarSet, pose: Point, count: int, *, step_m: Rational | None = None) -> list[Beam]:
    """Return what a perfect rangefinder reads evenly round, exactly or in whole steps; beyond the cut-off nothing."""
    return [_reading(obstacles, pose, math.tau * number / count, step_m) for number in range(count)]


def _reading(obstacles: PlanarSet, pose: Point, bearing_rad: float, step_m: Rational | None) -> Beam:
    arithmetic = arithmetic_of(pose.x)
    free = cast(obstacles, beam(bearing_rad, arithmetic(_FAR_M)), arithmetic(0), pose).free_length
    assert free is not None, "a closed room"
    assert not isinstance(free, Surd), "a rational pose"
    if free > CUT_OFF_M:
        return beam(bearing_rad, arithmetic(CUT_OFF_M), is_hit=False)
    reach = free if step_m is None else round(float(free / step_m)) * step_m
    return beam(bearing_rad, reach)


_SHAPES: tuple[list[tuple[int, int]], ...] = (
    [(2, 2), (7, 3), (6, 8), (1, 7)],
    [(2, 2), (8, 2), (8, 5), (2, 5)],
    [(1, 3), (4, 1), (8, 4), (6, 8)],
)


def scattered(edges: int, seed: int) -> tuple[PlanarSet, Point]:
    """Return a room with about this many edges, one quadrangle a square metre; and a free point in its middle."""
    rng = random.Random(seed)
    side = math.ceil(math.sqrt((edges - 4) / 4 + 1))
    places = [(x, y) for x in range(side) for y in range(side) if (x, y) != (side // 2, side // 2)]
    chosen = rng.sample(places, max(1, (edges - 4) // 4))
    obstacles = [Polygon(_placed(rng.choice(_SHAPES), x, y)) for x, y in chosen]
    room = ring_of([(0, 0), (side, 0), (side, side), (0, side)])
    middle = rational(2 * (side // 2) + 1) / 2
    return solid(obstacles, room=room), Point(middle, middle)


def _placed(shape: list[tuple[int, int]], x: int, y: int) -> Ring:
    return tuple(Point(x + rational(dx) / 10, y + rational(dy) / 10) for dx, dy in shape)


def crossed_bars(bars: int) -> tuple[PlanarSet, Beam]:
    """Return fig. 12: this many bars each way, n = 8 bars edges, whose gaps all hold a piece of FP of one reading.

    The bars are as wide as the gaps. A reading that ends on a wall from within a gap does so in every one.
    """
    side = 2 * bars + 1
    upright = [Polygon(_box(2 * number + 1, 0, 1, side)) for number in range(bars)]
    level = [Polygon(_box(0, 2 * number + 1, side, 1)) for number in range(bars)]
    return solid([*upright, *level]), Beam(rational("0.4"), rational("0.3"))


def halving_readings(count: int) -> tuple[PlanarSet, list[Beam]]:
    """Return fig. 13: a square room and readings whose ends lie on a diagonal line, each half as far from the next.

    Each is feasible on an angle of two segments, and every two angles cross.
    """
    room = ring_of([(0, 0), (4, 0), (4, 4), (0, 4)])
    ends = [2 - rational(1) / 2**number for number in range(count)]
    return solid([], room=room), [Beam(end, 3 - end) for end in ends]


def crossed_bars_and_readings(bars: int, count: int) -> tuple[PlanarSet, list[Beam]]:
    """Return fig. 12's map and fig. 13's readings, so short that they end on the walls of one gap."""
    walls, _ = crossed_bars(bars)
    _, long = halving_readings(count)
    return walls, [Beam(beam.dx / 4, beam.dy / 4) for beam in long]


def _box(x: int, y: int, width: int, height: int) -> Ring:
    return ring_of([(x, y), (x + width, y), (x + width, y + height), (x, y + height)])
