"""Heading first, then translation: separated orientation ([BrownDonald2000]_ sec. 2.2.3).

In uncluttered rooms most walls run along two axes at right angles. The readings show those axes in the robot's frame,
the map shows them in its own; where both do so clearly, the heading is the difference, up to quarter turns: four
headings instead of the hundreds of theta slices. Choose it for rooms and corridors of such walls. It fails where walls
run in many directions or where clutter hides them, and it says so: then no axis holds the share asked for, and
localization must try theta slices instead.

Directions of walls are those of lines fitted to the surroundings of each hit, and of each wall cell at the outside of
an obstacle. Each counts modulo 90 degrees, by the length of wall it stands for and by the fourth power of how straight
it is, so that corners count little. That says which axis is dominant, and how much so; to a tenth of a degree it is
found by :mod:`robotd.localization.orientation.sharpest_direction`.

**In simulated rooms**, 300 readings, sigma 2 cm, 5 % outliers, 152 sweeps of three rooms: with a cut-off of 6 m all
were usable, 0.7 degrees off at most (mean 0.1), with a support of at least 0.74; with 2.1 m 142 were, 2.1 degrees off
at most (mean 0.2), at least 0.62. Of 150 rooms of sixty short walls in random directions none was with 6 m (support
0.41 at most), and one with 2.1 m: there a piece of wall or two are all there is to see, and a piece of wall always
has an axis. Hence the least length of wall in sight; without it 29 % would have been taken for rooms with an axis.

**On real logs**, 5 cm maps of every second corrected scan, each of the others one 180-degree sweep to be turned:

====== ====== ======= ======== ======== ======== ========= =============
log    sweeps usable  within 1 within 2 within 3 over 5    within 1 deg,
              (share) deg      deg      deg      deg       of all sweeps
====== ====== ======= ======== ======== ======== ========= =============
intel  455    90 %    77 %     90 %     93 %     5.8 %     70 %
fr079  599    78 %    67 %     86 %     94 %     0.6 %     53 %
====== ====== ======= ======== ======== ======== ========= =============

The corrected poses are themselves good to half a degree or so. It is wrong by more than 5 degrees, up to 45, where a
half circle of beams sees one cluttered office and its furniture has an axis of its own: support is below 0.6 in most of
those. So in real buildings it is a first guess that saves time, never the only one: see
:mod:`robotd.localization.by_walls`.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.contract.walls_verdict import WallsVerdict
from robotd.core.angles import wrap_rad
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.footprints import dilate, disk_footprint
from robotd.localization.orientation.sharpest_direction import sharpest_direction

QUARTER_TURN_RAD = math.pi / 2.0
_HISTOGRAM_BINS = 180
_FIT_POINTS_MIN = 3
_STRAIGHTNESS_POWER = 4


@dataclass(frozen=True, slots=True)
class OrientationSettings:
    """What counts as a dominant axis."""

    window_m: float = 0.3
    """Radius of the surroundings of a point that a line is fitted to."""
    tolerance_rad: float = 0.0873
    """Walls within this much of an axis belong to it."""
    share_min: float = 0.45
    """Share of all walls, by length and straightness, that the dominant axis must hold; evenly spread walls give an
    axis ``2 tolerance_rad`` in a quarter turn, 0.11."""
    walls_min_m: float = 3.0
    """Length of wall that must be in sight; a piece or two always have an axis, but say nothing about the room."""
    heading_error_rad: float = 0.0523
    """How far off the headings found may be: up to that far away others are tried, too."""

    def __post_init__(self) -> None:
        """Refuse impossible values."""
        if not self.window_m > 0.0:
            raise ValueError(f"window_m must be positive, got {self.window_m}")
        if not 0.0 < self.tolerance_rad < QUARTER_TURN_RAD / 2.0:
            raise ValueError(f"tolerance_rad must lie in (0, pi / 4), got {self.tolerance_rad}")
        if not 0.0 < self.share_min <= 1.0:
            raise ValueError(f"share_min must lie in (0, 1], got {self.share_min}")
        if not self.walls_min_m > 0.0:
            raise ValueError(f"walls_min_m must be positive, got {self.walls_min_m}")
        if not 0.0 <= self.heading_error_rad < QUARTER_TURN_RAD / 2.0:
            raise ValueError(f"heading_error_rad must lie in [0, pi / 4), got {self.heading_error_rad}")


@dataclass(frozen=True, slots=True)
class Axis:
    """The direction that most walls run in, or at right angles to."""

    angle_rad: float
    """In ``[0, pi/2)``."""
    share: float
    """Of all walls, 0 to 1."""


@dataclass(frozen=True, slots=True)
class SeparatedOrientation:
    """The headings to try, or why there are none."""

    verdict: WallsVerdict
    headings_rad: tuple[float, ...]
    """Four, a quarter turn apart, in ``[-pi, pi)`` ascending; none unless usable."""
    support: float
    """Share of the walls on the dominant axis, of the map's or of the readings', whichever is less."""

    def headings_near(self, step_rad: float, settings: OrientationSettings) -> tuple[float, ...]:
        """Return the headings to search instead of all, ``[-pi, pi)`` ascending; none where walls do not tell.

        Round each of the four headings found as many as its error allows: at a step of a third of a degree 76 instead
        of 1080. They may be wrong (see above), so anyone who finds no good pose among them must search all headings.
        """
        # Rounded up, so that the outermost heading is no nearer than the error may be.
        steps = math.ceil(settings.heading_error_rad / step_rad - 1e-9)
        return tuple(sorted(wrap_rad(h + k * step_rad) for h in self.headings_rad for k in range(-steps, steps + 1)))


def separated_orientation(
    readings: Sequence[RangeReading], map_axis: Axis | None, settings: OrientationSettings
) -> SeparatedOrientation:
    """Return the headings under which the walls that the readings show run as those of the map do.

    Args:
        readings: of one stop, in the robot's frame; only hits count.
        map_axis: of :func:`map_axis`, once per map.
        settings: what counts as dominant.
    """
    if map_axis is None or map_axis.share < settings.share_min:
        return SeparatedOrientation(WallsVerdict.MAP_CLUTTERED, (), map_axis.share if map_axis else 0.0)
    if wall_in_sight_m(readings) < settings.walls_min_m:
        return SeparatedOrientation(WallsVerdict.LITTLE_IN_SIGHT, (), 0.0)
    axis = readings_axis(readings, settings)
    support = min(map_axis.share, axis.share) if axis else 0.0
    if axis is None or axis.share < settings.share_min:
        return SeparatedOrientation(WallsVerdict.READINGS_CLUTTERED, (), support)
    turn = map_axis.angle_rad - axis.angle_rad
    headings = sorted(wrap_rad(turn + quarter * QUARTER_TURN_RAD) for quarter in range(4))
    return SeparatedOrientation(WallsVerdict.USABLE, tuple(headings), support)


def wall_in_sight_m(readings: Sequence[RangeReading]) -> float:
    """Return about how much wall was hit: for each hit, the arc to the next of evenly spread readings."""
    bearings = np.sort([reading.bearing_rad for reading in readings])
    ranges = [reading.range_m or 0.0 for reading in readings if reading.status is ReadingStatus.OK]
    return sum(ranges) * float(np.median(np.diff(bearings))) if len(bearings) > 1 else 0.0


def readings_axis(readings: Sequence[RangeReading], settings: OrientationSettings) -> Axis | None:
    """Return the dominant axis of the walls that were hit, in the robot's frame; None if no line can be fitted.

    A hit counts with its range, as does the piece of wall between it and the next one. O(hits^2).
    """
    hits = [reading for reading in readings if reading.status is ReadingStatus.OK]
    ranges = np.array([reading.range_m for reading in hits], np.float64)
    bearings = np.array([reading.bearing_rad for reading in hits])
    origins = np.array([(reading.origin_x_m, reading.origin_y_m) for reading in hits]).reshape(-1, 2)
    points = origins + ranges[:, None] * np.stack((np.cos(bearings), np.sin(bearings)), axis=1)
    offsets = points[None, :, :] - points[:, None, :]
    near = np.hypot(offsets[..., 0], offsets[..., 1]) <= settings.window_m
    x, y = np.moveaxis(np.where(near[..., None], offsets, 0.0), -1, 0)
    sums = np.array([near, x, y, x * x, x * y, y * y]).sum(axis=2)
    angles, straightness = _lines(sums)
    axis = _dominant(angles, straightness**_STRAIGHTNESS_POWER * ranges, settings.tolerance_rad)
    return axis and _sharpened(axis, points, ranges, settings.tolerance_rad)


def map_axis(walls: NDArray[np.bool_], resolution_m: float, settings: OrientationSettings) -> Axis | None:
    """Return the dominant axis of a map's walls, in its frame; None if no line can be fitted.

    Args:
        walls: ``bool[rows, cols]``, cells known to be occupied. Unknown ones are no walls: their edge is where seeing
            ended.
        resolution_m: side of one cell.
        settings: what counts as dominant.
    """
    # Solid obstacles have the directions of their outlines.
    outline = walls & dilate(~walls, disk_footprint(1.0), outside=True)
    window_cells = max(1, round(settings.window_m / resolution_m))
    rows, cols = np.argwhere(outline).T
    sums = np.zeros((6, len(rows)))
    around = np.pad(outline, window_cells)
    for y, x in np.argwhere(disk_footprint(window_cells)) - window_cells:
        near = around[rows + window_cells + y, cols + window_cells + x]
        sums += np.array([[1.0], [x], [y], [x * x], [x * y], [y * y]]) * near
    angles, straightness = _lines(sums)
    axis = _dominant(angles, straightness**_STRAIGHTNESS_POWER, settings.tolerance_rad)
    points = np.stack((cols, rows), axis=1).astype(np.float64) * resolution_m
    return axis and _sharpened(axis, points, np.ones(len(points)), settings.tolerance_rad)


def _sharpened(axis: Axis, points_m: NDArray[np.float64], weights: NDArray[np.float64], within_rad: float) -> Axis:
    """Return the axis turned to where the points line up best."""
    angle = sharpest_direction(points_m, weights, axis.angle_rad, within_rad)
    return Axis(angle % QUARTER_TURN_RAD, axis.share)


def _lines(sums: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Fit lines to sets of points by total least squares.

    Args:
        sums: ``float64[6, n]``, over each set, of 1, x, y, x x, x y and y y.

    Returns:
        Directions ``float64[n]``, and how straight they are, from 0 (a blob) to 1 (a line).
    """
    n, x, y = sums[:3]
    xx, xy, yy = sums[3:] - np.array([x * x, x * y, y * y]) / n
    length = np.hypot(xx - yy, 2.0 * xy)
    total = xx + yy
    # Through two points there always goes a perfectly straight line.
    enough = (n >= _FIT_POINTS_MIN) & (total > 0.0)
    straightness = np.divide(length, total, out=np.zeros_like(total), where=enough)
    return np.arctan2(2.0 * xy, xx - yy) / 2.0, straightness


def _dominant(angles_rad: NDArray[np.float64], weights: NDArray[np.float64], tolerance_rad: float) -> Axis | None:
    """Return the axis, modulo 90 degrees, with the most weight within the tolerance of it."""
    total = float(weights.sum())
    if total == 0.0:
        return None
    folded = np.mod(angles_rad, QUARTER_TURN_RAD)
    bin_rad = QUARTER_TURN_RAD / _HISTOGRAM_BINS
    bins = np.minimum((folded / bin_rad).astype(np.intp), _HISTOGRAM_BINS - 1)
    histogram = np.bincount(bins, weights, _HISTOGRAM_BINS)
    # Bins only find the axis; its angle is the mean of what lies near, which no bin rounds.
    centres = np.linspace(0.0, QUARTER_TURN_RAD, _HISTOGRAM_BINS, endpoint=False) + bin_rad / 2.0
    held = (np.abs(_apart(centres[:, None], centres)) <= tolerance_rad) @ histogram
    best = float(centres[held.argmax()])
    off = _apart(folded, best)
    # What the fullest bins hold may lie half a bin beyond the tolerance.
    near = np.abs(off) <= tolerance_rad + bin_rad
    angle = math.fmod(best + float(np.average(off[near], weights=weights[near])) + QUARTER_TURN_RAD, QUARTER_TURN_RAD)
    within = np.abs(_apart(folded, angle)) <= tolerance_rad
    return Axis(angle, float(weights[within].sum()) / total)


def _apart(angles_rad: NDArray[np.float64], from_rad: NDArray[np.float64] | float) -> NDArray[np.float64]:
    """Return how far angles are from others modulo 90 degrees, in ``[-45, 45)`` degrees."""
    half = QUARTER_TURN_RAD / 2.0
    apart: NDArray[np.float64] = np.mod(angles_rad - from_rad + half, QUARTER_TURN_RAD) - half
    return apart
