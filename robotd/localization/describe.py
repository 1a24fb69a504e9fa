"""Regions in numbers: where they are, how far they reach, which readings they explain, and the best pose in each."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robotd.contract.estimate import Covariance, Extent, Region
from robotd.core.angles import wrap_rad
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid.pose_set import PoseSet
from robotd.grid.readings import Readings
from robotd.grid.wall_field import WallField
from robotd.localization.count.explained import explained_at
from robotd.localization.fit.refinement import PoseBox, RefinedPoses, refine
from robotd.localization.fit.refinement_settings import RefinementSettings
from robotd.localization.judged_regions import JudgedRegion
from robotd.localization.places.shapes import best_pose, centre_of, circle_of, cover_of, extent_of
from robotd.localization.ready_map import ReadyMap

_NEAR_M, _NEAR_RAD = 0.15, 0.03
"""The second look has moved its places uphill, by eye: the top of the hill is as near as that."""
_RUNS_MAX = 32
"""Longest list of cells in a message: about 300 bytes. What would be longer is told in coarser blocks."""


@dataclass(frozen=True, slots=True, eq=False)
class Situation:
    """What regions are described by: the map, the headings that were tried, and the readings."""

    the_map: ReadyMap
    walls: WallField
    """What the map means that the readings say it does."""
    headings_rad: tuple[float, ...]
    readings: Readings
    refinement: RefinementSettings

    @property
    def spec(self) -> GridSpec:
        """Where the cells lie."""
        return self.the_map.spec

    def refined(self, boxes: Sequence[PoseBox]) -> RefinedPoses:
        """Return the pose in each box that fits the readings best."""
        return refine(self.walls, self.readings, boxes, self.refinement)


def described(regions: Sequence[JudgedRegion], situation: Situation) -> tuple[Region, ...]:
    """Return regions as they are told, in the same order."""
    if not regions:
        return ()
    extents = [extent_of(region.piece.poses, situation.spec, situation.headings_rad) for region in regions]
    boxes = [_box(region, extent, situation) for region, extent in zip(regions, extents, strict=True)]
    # All boxes in one call: the readings' heads are worked out once for all of them.
    wide = situation.refined(boxes)
    # The box round a region that is no box holds cells that are not in it: there its nearest cell must do.
    narrow = situation.refined(
        [_box_of_cell(region.piece, box, situation) for region, box in zip(regions, boxes, strict=True)]
    )
    fits = (
        _Fit.of(wide if _holds(region.piece, wide.pose(number), situation) else narrow, number)
        for number, region in enumerate(regions)
    )
    return tuple(
        _described(region, extent, fit, situation) for region, extent, fit in zip(regions, extents, fits, strict=True)
    )


@dataclass(frozen=True, slots=True)
class _Fit:
    """One refined pose."""

    pose: Pose2
    covariance: Covariance
    residual_m: float

    @classmethod
    def of(cls, refined: RefinedPoses, number: int) -> "_Fit":
        x, y, heading = (tuple(row) for row in refined.covariances[number].tolist())
        return cls(refined.pose(number), (x, y, heading), float(refined.residual_m[number]))


def _described(region: JudgedRegion, extent: Extent, fit: _Fit, situation: Situation) -> Region:
    piece, spec, headings_rad = region.piece, situation.spec, situation.headings_rad
    cells = piece.cells()
    heading, row, col = best_pose(piece)
    prepared = situation.the_map.prepared
    # At the cell's centre and the slice's heading, as the plain count asked; the refined pose may explain others.
    explained = explained_at(prepared, situation.readings, (row, col), headings_rad[heading])
    return Region(
        belief=region.belief,
        pose=fit.pose,
        covariance=fit.covariance,
        residual_m=fit.residual_m,
        centre=centre_of(piece, spec, headings_rad),
        extent=extent,
        circle=circle_of(cells, spec),
        cover=cover_of(cells, _RUNS_MAX),
        cells=len(cells),
        poses=len(piece),
        best_rank=piece.best_rank,
        explained=tuple(explained.tolist()),
    )


def _box(region: JudgedRegion, extent: Extent, situation: Situation) -> PoseBox:
    """Return the box round a region; where a place in it is known to be the best, only what is near to that."""
    begin = region.begin or _best_of(region.piece, situation)
    # The second look climbs wherever it likes, so its place may lie outside the region: begin where that is nearest.
    x_m = min(max(begin.x_m, extent.x_min_m), extent.x_max_m)
    y_m = min(max(begin.y_m, extent.y_min_m), extent.y_max_m)
    heading_rad = _heading_in(extent, begin.heading_rad)
    # Without such a place nothing says where in the region the hill is, so all of it is searched.
    half_m, half_rad = (math.inf, math.inf) if region.begin is None else (_NEAR_M, _NEAR_RAD)
    bounds = Extent(
        max(extent.x_min_m, x_m - half_m),
        min(extent.x_max_m, x_m + half_m),
        max(extent.y_min_m, y_m - half_m),
        min(extent.y_max_m, y_m + half_m),
        max(extent.heading_min_rad, heading_rad - half_rad),
        min(extent.heading_max_rad, heading_rad + half_rad),
    )
    return PoseBox(Pose2(x_m, y_m, heading_rad), bounds)


def _heading_in(extent: Extent, heading_rad: float) -> float:
    """Return the heading of an extent that is nearest to another, counted as the extent counts."""
    middle_rad = (extent.heading_min_rad + extent.heading_max_rad) / 2
    # Extents are not wrapped: of all turns that mean the same heading take the one that lies nearest.
    near_rad = middle_rad + wrap_rad(heading_rad - middle_rad)
    return min(max(near_rad, extent.heading_min_rad), extent.heading_max_rad)


def _best_of(piece: PoseSet, situation: Situation) -> Pose2:
    heading, row, col = best_pose(piece)
    return Pose2(*situation.spec.centre_of(row, col), situation.headings_rad[heading])


def _box_of_cell(piece: PoseSet, box: PoseBox, situation: Situation) -> PoseBox:
    """Return the cell of a region that is nearest to where a box begins."""
    spec = situation.spec
    half_m = spec.resolution_m / 2
    # Positions count from a cell's corner; less a half, whole numbers are centres, as rows and columns are.
    place = spec.positions_at(np.array([[box.start.x_m, box.start.y_m]]))[0] - 0.5
    off = piece.poses[:, 1:] - place
    row, col = piece.poses[int(np.hypot(off[:, 0], off[:, 1]).argmin()), 1:].tolist()
    x_m, y_m = spec.centre_of(row, col)
    headings = box.bounds.heading_min_rad, box.bounds.heading_max_rad
    cell = Extent(x_m - half_m, x_m + half_m, y_m - half_m, y_m + half_m, *headings)
    return PoseBox(Pose2(x_m, y_m, box.start.heading_rad), cell)


def _holds(piece: PoseSet, pose: Pose2, situation: Situation) -> bool:
    """Whether the cell of a pose is one of the region's."""
    return piece.holds_cell(*situation.spec.cell_at(pose.x_m, pose.y_m))
