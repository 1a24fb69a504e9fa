"""Places where the robot may be, and a way from there: data, as the head is asked and answers."""

from dataclasses import dataclass

from robotd.contract.estimate import Region
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2

_POINT_M = 0.3
"""A region of no greater radius is stood for by its pose: clearances are as wide."""
_SPOTS_MAX = 48


@dataclass(frozen=True, slots=True)
class Rival:
    """A place where the robot may be."""

    pose: Pose2
    spots_m: tuple[tuple[float, float], ...]
    """All over the place, map frame: of one that reaches far, a way must be free from everywhere in it."""

    @classmethod
    def of(cls, region: Region, spec: GridSpec) -> "Rival":
        """Return a region of an estimate as a rival, on a map whose cells lie so."""
        pose = region.pose
        here = (pose.x_m, pose.y_m)
        if region.circle.radius_m <= _POINT_M:
            return cls(pose, (here,))
        side = region.cover.block_cells
        blocks = [(row, col) for row, first, last in region.cover.runs for col in range(first, last + 1)]
        # Evenly through the list, which goes through the region row by row.
        thinned = blocks[:: max(1, -(-len(blocks) // _SPOTS_MAX))]
        middle = (side - 1) / 2.0
        spots_m = (
            (
                spec.origin_x_m + (col * side + middle + 0.5) * spec.resolution_m,
                spec.origin_y_m + (row * side + middle + 0.5) * spec.resolution_m,
            )
            for row, col in thinned
        )
        return cls(pose, (here, *spots_m))


@dataclass(frozen=True, slots=True)
class SafeWay:
    """Where to drive from where the robot stands, before the next look."""

    corners_m: tuple[tuple[float, float], ...]
    """Ends of its straight legs, in the robot frame."""
    length_m: float
    rest_m: float
    """How far it is from the last of them to where rivals are told apart."""
    told_apart: float
    """Share of a sweep there that differs, mean over pairs of rivals, each no more than is needed."""
