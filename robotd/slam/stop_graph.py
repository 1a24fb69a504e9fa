"""All stops, where they are, and what ties them: the truth that maps are made of."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.slam.graph import Edge
from robotd.slam.stops import PlacedStop, Poses


@dataclass(frozen=True, slots=True, eq=False)
class StopGraph:
    """Stops in their order, their poses on the map, and the edges between them."""

    stops: tuple[PlacedStop, ...] = ()
    poses: Poses = field(default_factory=lambda: np.empty((0, 3)))
    edges: tuple[Edge, ...] = ()

    def pose(self, stop: int) -> Pose2:
        """Return where a stop is, map frame; -1 is the last."""
        x_m, y_m, heading_rad = self.poses[stop].tolist()
        return Pose2(x_m, y_m, heading_rad)

    @property
    def laid(self) -> NDArray[np.intp]:
        """The stops that maps are made of, ascending."""
        return np.flatnonzero([stop.is_laid for stop in self.stops])

    def with_stop(self, stop: PlacedStop, pose: Pose2, *edges: Edge) -> "StopGraph":
        """Return it with one more stop, and what ties it to others."""
        # A new array: the survey before this one may be gone on with, if the mission is stopped now.
        poses = np.concatenate((self.poses, [(pose.x_m, pose.y_m, pose.heading_rad)]))
        return StopGraph((*self.stops, stop), poses, (*self.edges, *edges))

    def with_edges(self, edges: Sequence[Edge]) -> "StopGraph":
        """Return it with more edges; no stop moves by that, see :func:`.solve.solve`."""
        return replace(self, edges=(*self.edges, *edges))

    def moved_to(self, poses: Poses) -> "StopGraph":
        """Return it with its stops at other poses ``float64[n, 3]``, map frame; the edges stay."""
        return replace(self, poses=poses)

    def off_m(self, pose: Pose2, stops: Sequence[int] | NDArray[np.intp]) -> NDArray[np.float64]:
        """Return how far stops are from a pose, ``float64[k]``."""
        return np.hypot(self.poses[stops, 0] - pose.x_m, self.poses[stops, 1] - pose.y_m)

    def laid_about(self, pose: Pose2, within_m: float) -> NDArray[np.intp]:
        """Return the stops near to a pose that maps are made of, ascending."""
        laid = self.laid
        return laid[self.off_m(pose, laid) <= within_m]
