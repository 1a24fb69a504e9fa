"""The rasterized and the exact algorithm agree on maps that are made of cells, up to bounds that are written down here.

Lengths in cells; delta is a cell's diagonal, sqrt(2), or a hair more. A robot stands at the centre of a cell. Let
``raster(eps)`` be the cells of :mod:`.feasible_poses`, and D, E the exact sets of one reading.

**Whatever is exactly feasible at eps - delta is feasible in the raster at eps.** The obstacle point within eps - delta
of the beam's end is at most half a diagonal from the centre of its cell, and so is the end from the centre of the head:
centre to centre at most eps. And the body's cells are those of points on the beam itself, all nearer than r - eps: if
one is occupied, the exact body, which is longer, runs through its inside.

**Whatever is feasible in the raster at eps is exactly feasible at eps + delta, but for corners that the beam may
clip.** Without that exception the sentence is false, as a test here shows; so the bound in this direction is the
exact answer at eps + delta with E of a map whose free space is half a cell wider.

The head is within eps of the centre of an occupied cell, so the end is within eps + delta / 2 of the obstacle.
The body of the raster is sampled once per cell of its dominant axis, at the middle, and its slope is at most 1: between
two samples the beam may run through a cell that is not looked at, but it stays within half a cell of free ones. So E is
that of the map shrunk by half a cell, in either axis. No smaller shrinking will do: a beam at 45 degrees clips half a
cell.
"""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.core.reading import RangeReading, ReadingStatus
from robotd.exact.beams import Beam, beam
from robotd.exact.feasible import PolygonMap, is_feasible
from robotd.exact.locate import contains
from robotd.exact.minkowski import blocked
from robotd.exact.outlines import outlines
from robotd.exact.planar import PlanarSet
from robotd.exact.points import Point
from robotd.exact.rationals import Rational, rational
from robotd.exact.sweep import arrange
from robotd.grid.footprints import dilate
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.reference.feasible_poses import feasible_poses
from robotd.localization.reference.probe import probe_of

DIAGONAL = rational("1.41422")
"""delta: a rational number just above sqrt(2)."""

sides = st.integers(4, 9)
maps = hnp.arrays(np.bool_, st.tuples(sides, sides), elements=st.sampled_from([True, False, False, False, False]))
bearings = st.integers(0, 71).map(lambda number: math.tau * number / 72) | st.floats(-math.pi, math.pi)
ranges = st.integers(2, 28).map(lambda quarters: rational(quarters) / 4)


@st.composite
def readings(draw: st.DrawFn) -> Beam:
    return beam(draw(bearings), draw(ranges), is_hit=draw(st.sampled_from([True, True, False])))


def raster(occupied: NDArray[np.bool_], reading: Beam, eps: int) -> NDArray[np.bool_]:
    status = ReadingStatus.OK if reading.is_hit else ReadingStatus.MISS
    measured = RangeReading(0, math.atan2(reading.dy, reading.dx), status, float(reading.length))
    probe = probe_of(measured, 0.0, resolution_m=1.0, error_radius_cells=float(eps), reach_cells=100)
    return feasible_poses(Obstacles.of(occupied, float(eps)), probe)


def exact(occupied: NDArray[np.bool_], blocking: PlanarSet, reading: Beam, eps: Rational) -> NDArray[np.bool_]:
    """Return which cells' centres are exactly feasible, with E of another map than D."""
    polygon_map = PolygonMap(outlines(occupied, rational(1)), eps)
    ends = polygon_map.endpoint_set(reading) if reading.is_hit else PlanarSet(far=True)
    parts = blocked(blocking, (reading.dx, reading.dy), reading.body_share(eps))
    feasible = arrange([ends, *parts]).select(is_feasible)
    belongs = np.zeros_like(occupied)
    for row, col in np.ndindex(occupied.shape):
        belongs[row, col] = contains(feasible, Point(rational(2 * col + 1) / 2, rational(2 * row + 1) / 2))
    return belongs


def shrunk(occupied: NDArray[np.bool_]) -> PlanarSet:
    """Return the occupied cells less half a cell wherever they border on free ones, corners included."""
    halves = np.repeat(np.repeat(occupied, 2, axis=0), 2, axis=1)
    return outlines(~dilate(~halves, np.ones((3, 3), np.bool_)), rational("1/2"))


@settings(max_examples=60, deadline=None)
@given(maps, readings(), st.integers(2, 4))
def test_what_is_exactly_feasible_at_a_smaller_error_is_feasible_in_the_raster(
    occupied: NDArray[np.bool_], reading: Beam, eps: int
) -> None:
    truth = exact(occupied, outlines(occupied, rational(1)), reading, eps - DIAGONAL)
    assert not (truth & ~raster(occupied, reading, eps)).any()


@settings(max_examples=60, deadline=None)
@given(maps, readings(), st.integers(0, 3))
def test_what_is_feasible_in_the_raster_is_exactly_feasible_at_a_larger_error(
    occupied: NDArray[np.bool_], reading: Beam, eps: int
) -> None:
    truth = exact(occupied, shrunk(occupied), reading, eps + DIAGONAL)
    assert not (raster(occupied, reading, eps) & ~truth).any()


def test_without_the_exception_for_corners_the_second_bound_would_be_false() -> None:
    occupied = np.zeros((4, 5), np.bool_)
    occupied[0, 1] = True
    # From (0.5, 0.5) it runs through the upper left corner of that cell: at x = 1 it is at y = 0.92. The raster looks
    # at x = 1.5, where it is in the row above.
    reading = beam(math.radians(40.0), rational("3.75"), is_hit=False)
    assert raster(occupied, reading, 0)[0, 0]
    assert not exact(occupied, outlines(occupied, rational(1)), reading, DIAGONAL)[0, 0], "the plain statement fails"
    assert exact(occupied, shrunk(occupied), reading, DIAGONAL)[0, 0], "the corrected one holds"


def test_the_bounds_leave_something_to_agree_on() -> None:
    occupied = np.zeros((9, 9), np.bool_)
    occupied[3:6, 6:] = True
    reading = beam(0.0, rational(4))
    inner = exact(occupied, outlines(occupied, rational(1)), reading, 2 - DIAGONAL)
    outer = exact(occupied, shrunk(occupied), reading, 2 + DIAGONAL)
    middle = raster(occupied, reading, 2)
    assert 0 < inner.sum() < middle.sum() < outer.sum() < occupied.size
