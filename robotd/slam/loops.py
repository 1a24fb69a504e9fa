"""Closing loops: has the robot come back to where it was long ago, and what does that say of the way between?

A sweep is sought on a map of old stops alone, near to where it should be, and only one place is an answer. A small
correction is taken at its word. A large one bends the whole map, and rooms are alike: it is held until a second stop,
soon after, says the same.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.contract.area import Area
from robotd.core.angles import wrap_rad
from robotd.core.pose import Pose2
from robotd.localization.placing import Believed, found_within
from robotd.slam.graph import Edge, EdgeKind
from robotd.slam.local_map import LocalMaps
from robotd.slam.solve import system_at
from robotd.slam.stop_graph import StopGraph


@dataclass(frozen=True, slots=True)
class LoopSettings:
    """Where loops are sought, and when they are believed."""

    behind: int = 25
    """A stop with this many after it is old."""
    every: int = 2
    near_m: float = 3.0
    drift_sigmas: float = 2.5
    drift_m: float = 0.5
    drift_per_way: float = 0.03
    """Drift is never taken for less than this and that much of the way since a loop was closed last."""
    map_m: float = 8.0
    within_m: float = 1.0
    within_rad: float = math.radians(6.0)
    within_rad_per_m: float = math.radians(0.3)
    least_share: float = 0.5
    large_m: float = 0.25
    large_rad: float = math.radians(3.0)
    agree_m: float = 0.3
    agree_rad: float = math.radians(4.0)
    agree_within: int = 6
    """Stops after a large correction within which a second one must agree."""
    floor_m: float = 0.02
    floor_rad: float = math.radians(0.35)
    """No loop is surer than this: what claims too much turns robust weights against the truth."""


@dataclass(frozen=True, slots=True, eq=False)
class Loop:
    """A stop that was found on stops of long ago."""

    stop: int
    old: int
    """The one of these that is nearest to it."""
    found: Pose2
    """Where it was found, map frame of then."""
    edge: Edge
    correction: Pose2
    """What takes where the stop was believed to be to where it was found, map frame."""
    moved_m: float
    moved_rad: float

    def is_large(self, settings: LoopSettings) -> bool:
        """Whether it bends the map by more than one stop is believed."""
        return self.moved_m >= settings.large_m or self.moved_rad >= settings.large_rad

    def agrees(self, other: "Loop", settings: LoopSettings) -> bool:
        """Whether another loop, found on the same poses, says the same of the way between."""
        # What the first says of the second's place: two loops agree if they move the same stretch in the same
        # way.
        expected = self.correction @ other.correction.inverse() @ other.found
        off_rad = abs(wrap_rad(expected.heading_rad - other.found.heading_rad))
        return expected.distance_m(other.found) <= settings.agree_m and off_rad <= settings.agree_rad


def seek(graph: StopGraph, way_since_m: float, maps: LocalMaps, settings: LoopSettings) -> Loop | None:
    """Return where the last stop is found on old ones; None if there are none near, or it is not found on them.

    Args:
        graph: all stops, and what ties them.
        way_since_m: how far the robot came since a loop was closed.
        maps: how maps are made.
        settings: where to look.
    """
    stop = len(graph.stops) - 1
    believed, laid = graph.pose(stop), graph.laid
    # Only stops of long ago: on the last ones it was placed already, and would be found there again.
    old = laid[laid <= stop - settings.behind]
    if not len(old):
        return None
    off_m = graph.off_m(believed, old)
    drift_m = settings.drift_m + settings.drift_per_way * way_since_m
    # Working out how far it may have drifted costs more than anything before it.
    if off_m.min() > settings.near_m + max(drift_m, _DRIFT_MAX_M):
        return None
    # Relative to the old stop, not to the map's origin: far from that every stop is unsure, and equally so.
    relative = system_at(graph).relative_covariance(stop, [int(old[off_m.argmin()])])[0]
    drift_m = max(drift_m, settings.drift_sigmas * math.sqrt(max(relative[0, 0], relative[1, 1])))
    if off_m.min() > settings.near_m + drift_m:
        return None
    # A map of old stops alone: on one with the last ones in it every sweep would fit where it is believed.
    some = old[off_m <= settings.map_m + drift_m]
    area = Area(believed.x_m, believed.y_m, settings.within_m + 2.0 * drift_m)
    half_rad = settings.within_rad + settings.within_rad_per_m * way_since_m
    ground, readings = maps.ground(graph, some, believed), graph.stops[stop].readings
    found = found_within(ground, readings, area, (believed.heading_rad, half_rad), settings.least_share)
    return None if found is None else _loop(graph, some, found, settings)


def _loop(graph: StopGraph, some: NDArray[np.intp], found: Believed, settings: LoopSettings) -> Loop:
    stop, pose = len(graph.stops) - 1, found.pose
    believed, old = graph.pose(stop), int(some[graph.off_m(pose, some).argmin()])
    edge = edge_to(graph, old, stop, found.no_surer(settings.floor_m, settings.floor_rad), EdgeKind.LOOP)
    moved_rad = abs(wrap_rad(pose.heading_rad - believed.heading_rad))
    return Loop(stop, old, pose, edge, pose @ believed.inverse(), pose.distance_m(believed), moved_rad)


def edge_to(graph: StopGraph, earlier: int, later: int, found: Believed, kind: EdgeKind) -> Edge:
    """Return what it says of two stops that the later one was found at a pose."""
    # Along the axes of the later stop: the edge must mean the same after both have moved.
    covariance = turned(found.covariance, -found.pose.heading_rad)
    return Edge(earlier, later, graph.pose(earlier).inverse() @ found.pose, covariance, kind)


def turned(covariance: NDArray[np.float64], by_rad: float) -> NDArray[np.float64]:
    """Return a covariance ``float64[3, 3]`` of x, y and heading along axes turned by an angle."""
    cosine, sine = math.cos(by_rad), math.sin(by_rad)
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    found: NDArray[np.float64] = turn @ covariance @ turn.T
    return found


_DRIFT_MAX_M = 15.0
"""Beyond this and ``near_m`` it is not worth asking how far the robot may have drifted."""
