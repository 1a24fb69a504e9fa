"""Regions in numbers: where they are, how far they reach, which readings they explain, and the best pose in each."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.grid.spec import GridSpec
from robotd.localization.estimate import Covariance, Extent, Region
from robotd.localization.explained import explained_at
from robotd.localization.ready_map import ReadyMap
from robotd.localization.refinement import PoseBox, RefinedPoses, RefinementSettings, refine
from robotd.localization.regions import Piece
from robotd.localization.shapes import best_pose, cells_of, centre_of, circle_of, cover_of, extent_of

_RUNS_MAX = 32
"""Longest list of cells in a message: about 300 bytes. What would be longer is told in coarser blocks."""


@dataclass(frozen=True, slots=True, eq=False)
class Situation:
    """What regions are described by: the map, the headings that were tried, and the readings."""

    the_map: ReadyMap
    headings_rad: tuple[float, ...]
    readings: NDArray[np.float64]
    """``float64[n, 5]``, of :func:`robotd.grid.readings.numbers_of`."""
    refinement: RefinementSettings

    @property
    def spec(self) -> GridSpec:
        """Where the cells lie."""
        return self.the_map.ternary.spec

    def refined(self, boxes: Sequence[PoseBox]) -> RefinedPoses:
        """Return the pose in each box that fits the readings best."""
        return refine(self.the_map.walls, self.readings, boxes, self.refinement)


def described(pieces: Sequence[Piece], situation: Situation) -> tuple[Region, ...]:
    """Return regions as they are told, in the same order."""
    if not pieces:
        return ()
    extents = [extent_of(piece.poses, situation.spec, situation.headings_rad) for piece in pieces]
    boxes = [_box(piece, extent, situation) for piece, extent in zip(pieces, extents, strict=True)]
    wide = situation.refined(boxes)
    # The box round a region that is no box holds cells that are not in it: there its best cell must do.
    narrow = situation.refined([_box_of_cell(box, situation) for box in boxes])
    fits = (
        _Fit.of(wide if _holds(piece, wide.pose(number), situation) else narrow, number)
        for number, piece in enumerate(pieces)
    )
    return tuple(
        _described(piece, extent, fit, situation) for piece, extent, fit in zip(pieces, extents, fits, strict=True)
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


def _described(piece: Piece, extent: Extent, fit: _Fit, situation: Situation) -> Region:
    spec, headings_rad = situation.spec, situation.headings_rad
    cells = cells_of(piece.poses, spec.cols)
    heading, row, col = best_pose(piece)
    prepared = situation.the_map.prepared
    explained = explained_at(prepared, situation.readings, (row, col), headings_rad[heading])
    return Region(
        pose=fit.pose,
        covariance=fit.covariance,
        residual_m=fit.residual_m,
        centre=centre_of(piece, spec, headings_rad),
        extent=extent,
        circle=circle_of(cells, spec),
        cover=cover_of(cells, _RUNS_MAX),
        cells=len(cells),
        poses=len(piece.poses),
        best_rank=int(piece.ranks.max()),
        explained=tuple(explained.tolist()),
    )


def _box(piece: Piece, extent: Extent, situation: Situation) -> PoseBox:
    """Return the box round a region, with its best pose to begin at; half a step of heading if one alone was tried."""
    heading, row, col = best_pose(piece)
    x_m, y_m = situation.spec.centre_of(row, col)
    beyond_rad = math.fmod(situation.headings_rad[heading] - extent.heading_min_rad, math.tau) % math.tau
    return PoseBox(
        Pose2(x_m, y_m, extent.heading_min_rad + beyond_rad),
        extent.x_min_m,
        extent.x_max_m,
        extent.y_min_m,
        extent.y_max_m,
        extent.heading_min_rad,
        max(extent.heading_max_rad, extent.heading_min_rad + beyond_rad),
    )


def _box_of_cell(box: PoseBox, situation: Situation) -> PoseBox:
    """Return the part of a box that is the cell it begins at."""
    half_m = situation.spec.resolution_m / 2
    x_m, y_m = box.start.x_m, box.start.y_m
    return PoseBox(
        box.start, x_m - half_m, x_m + half_m, y_m - half_m, y_m + half_m, box.heading_min_rad, box.heading_max_rad
    )


def _holds(piece: Piece, pose: Pose2, situation: Situation) -> bool:
    """Whether the cell of a pose is one of the region's."""
    row, col = situation.spec.cell_at(pose.x_m, pose.y_m)
    return bool(((piece.poses[:, 1] == row) & (piece.poses[:, 2] == col)).any())
