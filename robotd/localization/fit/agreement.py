"""What a map says of each reading of a sweep: that it explains it, that it speaks against it, or nothing.

The third is not the second. Most readings that a young map does not explain end where nobody has looked; who takes
that for a contradiction loses the robot at each door. And heads are judged by how far they are from a wall, not by
where beams that are cast would end: beams slip through walls that few stops have drawn.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.grid.readings import Readings
from robotd.grid.wall_field import WallField
from robotd.localization.fit.refinement import DISTANCES, Heads, ranges_along
from robotd.localization.fit.refinement_settings import Walls

_NEAR_M = 0.12
"""A head is on a wall that is no farther."""
_FAR_M = 0.25
"""A head that is farther from every wall, on ground that was seen vacant, ends where nothing is; and a wall is in the
way of a beam if it stands so far before its end."""
_BLOCKED_BY = 2
"""Cells that a beam must meet to be stopped: one lets no beam graze along a wall."""


@dataclass(frozen=True, slots=True, eq=False)
class Agreement:
    """What a map says of the ``m`` readings of a sweep at one pose."""

    explained: NDArray[np.bool_]
    """``bool[m]``: hits that end on a wall, misses that go through vacant ground."""
    contradicted: NDArray[np.bool_]
    """``bool[m]``: a wall stands in the way, or none where the reading ends. The rest is new."""

    @property
    def explained_share(self) -> float:
        """Of all readings."""
        return float(self.explained.mean()) if len(self.explained) else 0.0

    @property
    def contradicted_share(self) -> float:
        """Of all readings."""
        return float(self.contradicted.mean()) if len(self.contradicted) else 0.0

    @property
    def consent(self) -> float:
        """Explained ones among those of which the map says anything at all."""
        told = self.explained_share + self.contradicted_share
        return self.explained_share / told if told else 0.0


def agreement(walls: WallField, vacant: NDArray[np.bool_], readings: Readings, pose: Pose2) -> Agreement:
    """Return what a map says of a sweep at a pose; see :func:`agreements`."""
    at = np.array([[pose.x_m, pose.y_m, pose.heading_rad]])
    explained, contradicted = agreements(walls, vacant, readings, at)
    return Agreement(explained[0], contradicted[0])


def agreements(
    walls: WallField, vacant: NDArray[np.bool_], readings: Readings, poses: NDArray[np.float64]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return what a map says of a sweep at poses: which readings it explains, and which it contradicts.

    Args:
        walls: of the map; walls alone block.
        vacant: ``bool[rows, cols]``: the cells that were seen, and seen vacant.
        readings: ``m`` hits and misses, robot frame.
        poses: ``float64[n, 3]``: x, y [m] and heading [rad] of the robot, map frame.

    Returns:
        Both ``bool[n, m]``, as in :class:`Agreement`. O(n m), and the way of the beams.
    """
    spec = walls.spec
    ways = ranges_along(walls, Heads.of(readings, spec.resolution_m).beams, poses, _BLOCKED_BY)
    # Only by a wall: where the map ends, or nobody has looked, nothing says that the beam could not go on.
    blocked = (ways.ranges_m < readings.range_m - _FAR_M) & ways.ends
    heads_m = np.stack([readings.heads_at(Pose2(*pose)) for pose in poses.tolist()])
    cells = spec.flat_at(heads_m.reshape(-1, 2)).reshape(blocked.shape)
    on_map = cells >= 0
    distance_m = np.full(blocked.shape, np.inf)
    codes = walls.codes.reshape(-1)[cells[on_map]].astype(np.intp)
    distance_m[on_map] = np.abs(DISTANCES[Walls.CENTRES][codes + 128]) * spec.resolution_m
    # Off the map a head lies in no vacant cell, so it can neither be explained there nor contradicted.
    in_vacant = np.zeros(blocked.shape, np.bool_)
    in_vacant[on_map] = vacant.reshape(-1)[cells[on_map]]
    is_miss = readings.is_miss
    explained = ~blocked & np.where(is_miss, in_vacant, distance_m <= _NEAR_M)
    # Between near and far lies nothing: a head 20 cm from a wall may be of that wall or of something before it.
    contradicted = blocked | ~is_miss & in_vacant & (distance_m > _FAR_M)
    return explained, contradicted
