"""From a cell to a point: the pose that best lays the heads of the readings on the walls, within a box round the cell.

Feasible poses ([BrownDonald2000]_ sec. 2.2.1) are cells; a sweep of 300 readings knows more than its cell. The sum of
robust squared distances from the heads to the nearest wall is minimized, from a start and within bounds that the pose
never leaves. It is said where in its cells a wall lies (:class:`Walls`), since that is worth half a cell: 25 mm.

The covariance is that of the weighted least squares: the inverse normal matrix times the variance of the distances,
which is taken from the readings themselves, times how much neighbouring readings err together. It tells how far the
pose may be from the place where endlessly many such readings would see it *on this map*. What the map has wrong all
along a wall no reading can tell: ``map_error_m`` is added for that. A direction in which the walls do not hold the pose
(a corridor) has a standard deviation of up to 256 cells, however small the box.
"""

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.contract.estimate import Extent
from robotd.core.angles import wrap_rad
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid import kernels
from robotd.grid.kernels.cast.cast_kernel import ENDS
from robotd.grid.kernels.fit.fit_kernel import Fits
from robotd.grid.readings import Readings
from robotd.grid.wall_field import WallField
from robotd.localization.fit.refinement_settings import RefinementSettings, Walls


@dataclass(frozen=True, slots=True)
class PoseBox:
    """Where a pose may lie, and where to begin; headings are not wrapped, so that bounds may go round."""

    start: Pose2
    bounds: Extent

    def __post_init__(self) -> None:
        """Refuse a box that holds nothing."""
        it = self.bounds
        # As a negation, so that NaN is refused, too.
        if not (it.x_min_m <= it.x_max_m and it.y_min_m <= it.y_max_m and it.heading_min_rad <= it.heading_max_rad):
            raise ValueError(f"bounds in the wrong order: {it}")

    @classmethod
    def around(cls, start: Pose2, half_m: float, half_rad: float) -> "PoseBox":
        """Return the box that reaches so far to all sides of a pose."""
        x_m, y_m, heading_rad = start.x_m, start.y_m, start.heading_rad
        reach = (x_m - half_m, x_m + half_m, y_m - half_m, y_m + half_m, heading_rad - half_rad, heading_rad + half_rad)
        return cls(start, Extent(*reach))


@dataclass(frozen=True, slots=True, eq=False)
class Heads:
    """Where the readings of a sweep end, in the robot frame, and which way they go."""

    at_cells: NDArray[np.float64]
    """``float64[hits, 2]``: x, y."""
    is_hit: NDArray[np.bool_]
    """``bool[m]``: which readings these are; misses have no head."""
    beams: NDArray[np.float64]
    """``float64[m, 4]``: x, y of the start [cells], cosine and sine of the bearing; of hits and misses."""

    @classmethod
    def of(cls, readings: Readings, resolution_m: float) -> "Heads":
        """Take them from readings, in cells."""
        # Columns, each in one piece: the rows are a few numbers wide, and every step below goes through one of
        # them.
        bearing_rad, range_, x, y, is_miss = columns = np.ascontiguousarray(readings.rows.T)
        columns[1:4] /= resolution_m
        cosine, sine, is_hit = np.cos(bearing_rad), np.sin(bearing_rad), is_miss == 0.0
        beams, at_cells = np.empty((len(readings), 4)), np.empty((len(readings), 2))
        beams[:, 0], beams[:, 1], beams[:, 2], beams[:, 3] = x, y, cosine, sine
        at_cells[:, 0], at_cells[:, 1] = x + range_ * cosine, y + range_ * sine
        # Most sweeps of a room have no miss, and then nothing is copied.
        return cls(at_cells if is_hit.all() else at_cells[is_hit], is_hit, beams)


@dataclass(frozen=True, slots=True, eq=False)
class RefinedPoses:
    """Refined poses, in the order of their boxes, and where each of ``m`` readings (hits and misses) then lies."""

    poses: NDArray[np.float64]
    """``float64[n, 3]``: x, y [m] and heading [rad, not wrapped], map frame."""
    covariances: NDArray[np.float64]
    """``float64[n, 3, 3]`` of x, y [m] and heading [rad]."""
    residual_m: NDArray[np.float64]
    """``float64[n]``: root of the weighted mean squared distance of the heads from the walls."""
    weight: NDArray[np.float64]
    """``float64[n]``: sum of the weights, so at most the number of hits."""
    beyond_m: NDArray[np.float64]
    """``float64[n, m]``: how far the head of each reading lies beyond the nearest wall, negative short of it; no more
    than 8 cells, which is far from any. NaN for a miss."""

    def pose(self, number: int) -> Pose2:
        """Return one of the poses."""
        x_m, y_m, heading_rad = self.poses[number].tolist()
        return Pose2(x_m, y_m, wrap_rad(heading_rad))


@dataclass(frozen=True, slots=True, eq=False)
class ExpectedRanges:
    """What a robot should measure from ``n`` poses."""

    ranges_m: NDArray[np.float64]
    """``float64[n, m]``: from the beam's start to the side of the cell that stops it."""
    ends: NDArray[np.bool_]
    """``bool[n, m]``: whether that is a wall; else what is there is unknown, or the map ends."""


def refine(
    field: WallField, readings: Readings, boxes: Sequence[PoseBox], settings: RefinementSettings
) -> RefinedPoses:
    """Return the best poses within boxes, for one sweep.

    Args:
        field: the map.
        readings: ``m`` hits and misses; misses have no head and no say.
        boxes: where to begin, and what not to leave.
        settings: where walls lie, and how robust.

    O(n m) for each of at most 32 steps.
    """
    return refine_heads(field, Heads.of(readings, field.spec.resolution_m), boxes, settings)


def refine_heads(
    field: WallField, heads: Heads, boxes: Sequence[PoseBox], settings: RefinementSettings
) -> RefinedPoses:
    """Do as :func:`refine` with readings that are used more than once."""
    spec = field.spec
    # In cells from the origin: the kernel then needs to know nothing of where the map lies.
    fits = kernels.in_use().fit.fit_poses(
        field.codes,
        DISTANCES[settings.walls],
        heads.at_cells,
        _in_cells(boxes, spec),
        settings.outlier_m / spec.resolution_m,
    )
    return _in_metres(fits, heads, _Units.of(spec, settings))


def expected_ranges(
    field: WallField, readings: Readings, poses: NDArray[np.float64], blocked_by: int
) -> ExpectedRanges:
    """Return how far each beam goes from continuous poses, exactly, to the side of the cell that stops it.

    Args:
        field: the map.
        readings: ``m`` of them; their ranges do not matter.
        poses: ``float64[n, 3]``: x, y [m] and heading [rad], map frame.
        blocked_by: how many blocking cells a beam must meet to be stopped, 1 or 2.
    """
    return ranges_along(field, Heads.of(readings, field.spec.resolution_m).beams, poses, blocked_by)


def ranges_along(
    field: WallField, beams: NDArray[np.float64], poses: NDArray[np.float64], blocked_by: int
) -> ExpectedRanges:
    """Do as :func:`expected_ranges` with the beams of :class:`Heads`."""
    spec, at = field.spec, np.empty((len(poses), 4))
    # Grids count (row, col), the kernel takes x before y.
    at[:, :2] = spec.positions_at(poses[:, :2])[:, ::-1]
    np.cos(poses[:, 2], at[:, 2])
    np.sin(poses[:, 2], at[:, 3])
    ways, stops = kernels.in_use().cast.cast_beams(field.skips, beams, at, blocked_by)
    ways *= spec.resolution_m
    return ExpectedRanges(ways, stops == ENDS)


def _in_cells(boxes: Sequence[PoseBox], spec: GridSpec) -> NDArray[np.float64]:
    """Return boxes as the kernel takes them, ``float64[n, 9]``."""
    x_m, y_m, size_m = spec.origin_x_m, spec.origin_y_m, spec.resolution_m
    rows = [
        (
            *((start.x_m - x_m) / size_m, (start.y_m - y_m) / size_m, start.heading_rad),
            *((bounds.x_min_m - x_m) / size_m, (bounds.y_min_m - y_m) / size_m, bounds.heading_min_rad),
            *((bounds.x_max_m - x_m) / size_m, (bounds.y_max_m - y_m) / size_m, bounds.heading_max_rad),
        )
        for start, bounds in ((box.start, box.bounds) for box in boxes)
    ]
    return np.array(rows, np.float64).reshape(-1, 9)


@dataclass(frozen=True, slots=True, eq=False)
class _Units:
    """What takes a pose in cells to one in metres, and its covariance; made once for a map."""

    resolution_m: float
    scale: NDArray[np.float64]
    """``float64[3]``."""
    origin: NDArray[np.float64]
    """``float64[3]``."""
    squared: NDArray[np.float64]
    """``float64[3, 3]``: the scale of a covariance."""
    map_error: NDArray[np.float64]
    """``float64[3, 3]``: what the map adds to it."""

    @staticmethod
    # A map is refined on again and again, and these arrays would be made each time.
    @functools.lru_cache(maxsize=8)
    def of(spec: GridSpec, settings: RefinementSettings) -> "_Units":
        scale = np.array([spec.resolution_m, spec.resolution_m, 1.0])
        origin = np.array([spec.origin_x_m, spec.origin_y_m, 0.0])
        map_error = np.array([settings.map_error_m, settings.map_error_m, settings.map_error_rad])
        return _Units(spec.resolution_m, scale, origin, scale[:, None] * scale, np.diag(map_error**2))


def _in_metres(fits: Fits, heads: Heads, units: _Units) -> RefinedPoses:
    beyond_m = fits.beyond * units.resolution_m
    # Misses have no head: their places are kept, so that all that is told of a sweep counts by reading.
    if len(heads.at_cells) < len(heads.is_hit):
        of_hits, beyond_m = beyond_m, np.full((len(fits.poses), len(heads.is_hit)), math.nan)
        beyond_m[:, heads.is_hit] = of_hits
    return RefinedPoses(
        poses=fits.poses * units.scale + units.origin,
        # Added after the fit, and not weighed in it: what the map has wrong all along a wall is not averaged
        # away by more readings.
        covariances=fits.covariances * units.squared + units.map_error,
        residual_m=np.sqrt(fits.quality[:, 1]) * units.resolution_m,
        weight=fits.quality[:, 0],
        beyond_m=beyond_m,
    )


def _distances(walls: Walls) -> NDArray[np.float64]:
    """Return what distance each code stands for, ``float64[256]`` [cells], by ``code + 128``."""
    codes = np.arange(-128, 128)
    roots = np.sqrt(np.abs(codes))
    if walls is Walls.FACES:
        # From the centre of a cell to the side of a wall's: half a cell less than to its centre, on either side.
        return np.where(codes > 0, roots - 0.5, 0.5 - roots)
    return np.where(codes > 0, roots, 0.0)


DISTANCES = {walls: _distances(walls) for walls in Walls}
"""What distance each code of a wall field stands for, ``float64[256]`` [cells], by ``code + 128``."""
