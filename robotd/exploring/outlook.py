"""What could be seen from a place, as far as the map goes: beams cast on it until they end on walls or in the unknown.

A beam is *open* if it ends in the unknown before the cut-off, and so do its neighbours over the width that a robot
needs to pass: slits, as wrong ranges leave them, are no openings. What lies beyond the bounds is not asked about.
Behind an opening lies ground that a stop would see, up to where the map knows on: the shadow of a table is small,
however wide it is open. How much of it is seen, is expected: a beam gets ``s`` farther into the unknown with a chance
of ``exp(-s / depth)``, and an opening is taken to be as deep as it is wide: what is narrow is a niche, or a wall that
was seen at too flat an angle, more often than a room.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.rectangle import Rectangle
from robotd.exploring.settings import ExploringSettings
from robotd.grid import kernels
from robotd.grid.kernels.cast.cast_kernel import BLOCKS, ENDS


@dataclass(frozen=True, slots=True, eq=False)
class Views:
    """What is to be seen from each of some places."""

    opening_m: NDArray[np.float64]
    """Width of all that is open, across the beams, ``float64[n]``."""
    area_m2: NDArray[np.float64]
    """Terrain that a stop is expected to add, ``float64[n]``."""
    overlap: NDArray[np.float64]
    """Share of the beams that end on known walls, ``float64[n]``."""
    behind_m2: NDArray[np.float64]
    """The terrain by where it begins, ``float64[n, stretches]``: a column for each stretch of the border that is seen
    from any of the places."""

    def __getitem__(self, which: NDArray[np.bool_] | NDArray[np.intp]) -> "Views":
        """Return those of some of the places."""
        return Views(self.opening_m[which], self.area_m2[which], self.overlap[which], self.behind_m2[which])


@dataclass(frozen=True, slots=True, eq=False)
class Outlook:
    """A map that beams are cast on."""

    spec: GridSpec
    skips: NDArray[np.uint8]
    """What stops a beam: walls, and the unknown."""
    unknown_skips: NDArray[np.uint8]
    """What stops a beam within the unknown: all that is known."""
    within: Rectangle
    """What is explored; never more than the map."""
    cut_off_m: float
    """Farther than this nothing is seen."""

    @classmethod
    def on(
        cls,
        spec: GridSpec,
        walls: NDArray[np.bool_],
        unknown: NDArray[np.bool_],
        within: Rectangle | None,
        cut_off_m: float,
    ) -> "Outlook":
        """Return the outlook on a map.

        Args:
            spec: where it lies.
            walls: ``bool[rows, cols]``.
            unknown: ``bool[rows, cols]``.
            within: what is explored; None is all.
            cut_off_m: farther than this nothing is seen.
        """
        cast = kernels.in_use().cast
        # Made once for a choice: thousands of candidates cast a hundred and eighty beams each.
        skips, unknown_skips = cast.skip_codes(walls, unknown), cast.skip_codes(~unknown, np.zeros_like(unknown))
        return cls(spec, skips, unknown_skips, _inside(extent_of(spec), within), cut_off_m)

    def views(self, places_m: NDArray[np.float64], settings: ExploringSettings) -> Views:
        """Return what is to be seen from places, ``float64[n, 2]`` of x, y in the map frame. O(n beams way)."""
        bearings_rad = settings.step_rad * np.arange(settings.beams)
        ahead = np.stack((np.cos(bearings_rad), np.sin(bearings_rad)), axis=1)
        ways_m, stops = self._cast(places_m, ahead)
        reach_m = np.minimum(self.cut_off_m, _way_out_m(places_m, ahead, self.within))
        # By half a cell: at the bounds themselves, rounding decides nothing.
        ends_before = ways_m + 0.5 * self.spec.resolution_m < reach_m
        widths_m = _widths_m((stops == BLOCKS) & ends_before, ways_m * settings.step_rad)
        open_ = widths_m >= settings.opening_min_m
        known_m = np.where(open_, ways_m, 0.0)
        at, beam = np.nonzero(open_)
        entered_m = places_m[at] + ahead[beam] * ways_m[open_, None]
        # As far as the map knows on: a beam that comes out on known ground has not found a hall.
        ends_m = np.minimum(ways_m[open_] + self._unknown_m(entered_m, ahead[beam]), reach_m[open_])
        depths_m = np.minimum(widths_m[open_], settings.depth_max_m)
        area_m2 = _expected(ways_m[open_], ends_m, depths_m) * settings.step_rad
        behind_m2 = _by_stretch(at, np.floor(entered_m / settings.stretch_m), area_m2, len(places_m))
        return Views(
            known_m.sum(axis=1) * settings.step_rad,
            behind_m2.sum(axis=1),
            ((stops == ENDS) & (ways_m < self.cut_off_m)).mean(axis=1),
            behind_m2,
        )

    def _cast(
        self, places_m: NDArray[np.float64], ahead: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
        """Return how far each beam goes from each place [m], and what stops it; both ``[places, beams]``."""
        beams = np.concatenate((np.zeros_like(ahead), ahead), axis=1)
        poses = self._poses(places_m, np.tile((1.0, 0.0), (len(places_m), 1)))
        ways, stops = kernels.in_use().cast.cast_beams(self.skips, beams, poses, 1)
        return ways * self.spec.resolution_m, stops

    def _unknown_m(self, entered_m: NDArray[np.float64], ahead: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how far each of some beams goes on in the unknown from where it enters it, ``float64[n]``."""
        # A little farther, so that it is in the cell that it entered, whatever rounding says.
        poses = self._poses(entered_m + _INTO * self.spec.resolution_m * ahead, ahead)
        ways, _ = kernels.in_use().cast.cast_beams(self.unknown_skips, _AHEAD, poses, 1)
        unknown_m: NDArray[np.float64] = ways[:, 0] * self.spec.resolution_m
        return unknown_m

    def _poses(self, places_m: NDArray[np.float64], ahead: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return poses as the kernel takes them: ``(x, y)`` in cells, where positions are ``(row, col)``."""
        return np.concatenate((self.spec.positions_at(places_m)[:, ::-1], ahead), axis=1)


def extent_of(spec: GridSpec) -> Rectangle:
    """Return what a map covers."""
    width_m, height_m = spec.cols * spec.resolution_m, spec.rows * spec.resolution_m
    return Rectangle(spec.origin_x_m, spec.origin_y_m, spec.origin_x_m + width_m, spec.origin_y_m + height_m)


def _inside(whole: Rectangle, within: Rectangle | None) -> Rectangle:
    if within is None:
        return whole
    west_m, south_m = max(whole.west_m, within.west_m), max(whole.south_m, within.south_m)
    return Rectangle(west_m, south_m, min(whole.east_m, within.east_m), min(whole.north_m, within.north_m))


def _way_out_m(places_m: NDArray[np.float64], ahead: NDArray[np.float64], within: Rectangle) -> NDArray[np.float64]:
    """Return how far it is from places inside along each direction to where the bounds end, ``[places, beams]``."""
    low, high = np.array((within.west_m, within.south_m)), np.array((within.east_m, within.north_m))
    sides = np.where(ahead > 0.0, high, low)
    # A beam that runs along an axis never comes to the sides across it.
    along = np.where(np.abs(ahead) < _ALONG, np.inf, np.abs(ahead))
    ways: NDArray[np.float64] = np.abs(sides - places_m[:, None, :]) / along
    ways[:, np.isinf(along)] = np.inf
    nearest: NDArray[np.float64] = ways.min(axis=2)
    return nearest


def _widths_m(open_: NDArray[np.bool_], across_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how wide the run of open beams, going round, is that each is of, 0 of the others; ``[places, beams]``."""
    places, beams = open_.shape
    # Twice round, so that each run is somewhere in one piece; where all beams are open, it is one that long.
    twice = np.concatenate((open_, open_), axis=1)
    run = np.cumsum(~twice, axis=1) + (2 * beams + 1) * np.arange(places)[:, None]
    weights = np.where(twice, np.concatenate((across_m, across_m), axis=1), 0.0)
    sums = np.bincount(run.ravel(), weights.ravel(), minlength=(2 * beams + 1) * places)[run]
    # And where all are, it was counted twice.
    widths_m = np.minimum(np.maximum(sums[:, :beams], sums[:, beams:]), weights[:, :beams].sum(axis=1, keepdims=True))
    return np.where(open_, widths_m, 0.0)


def _expected(
    ways_m: NDArray[np.float64], reach_m: NDArray[np.float64], depth_m: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the integral from ``way`` to ``reach`` of ``s exp(-(s - way) / depth) ds``: ground a radian, in m2."""
    beyond_m = np.maximum(reach_m - ways_m, 0.0)
    # In closed form: a sum over cells of each beam would cost as much as casting it.
    left = np.exp(-beyond_m / depth_m)
    expected: NDArray[np.float64] = ways_m * depth_m * (1.0 - left) + depth_m * (depth_m - left * (depth_m + beyond_m))
    return expected


def _by_stretch(
    at: NDArray[np.intp], squares: NDArray[np.float64], area_m2: NDArray[np.float64], places: int
) -> NDArray[np.float64]:
    """Return what beams from places are expected to see by the square where each enters the unknown."""
    _, stretches = np.unique(squares, axis=0, return_inverse=True)
    count = int(stretches.max(initial=-1)) + 1
    sums_m2 = np.bincount(at * count + stretches.reshape(-1), area_m2, minlength=places * count)
    return sums_m2.astype(np.float64).reshape(places, count)


_ALONG = 1e-12
_INTO = 1e-6
_AHEAD = np.array([[0.0, 0.0, 1.0, 0.0]])


def facing_rad(places_m: NDArray[np.float64], from_m: tuple[float, float], heading_rad: float) -> NDArray[np.float64]:
    """Return how far a robot turns to face each place, ``float64[n]``, from 0 to pi."""
    bearings_rad = np.arctan2(places_m[:, 1] - from_m[1], places_m[:, 0] - from_m[0])
    turns: NDArray[np.float64] = np.abs(np.mod(bearings_rad - heading_rad + math.pi, math.tau) - math.pi)
    return turns
