"""Where is the robot, when it is known within a few decimetres and degrees?

Asked at every stop of a map in the making (:mod:`robotd.localization.placing`).

In three steps: a lattice of poses in the prior box, on which the heads of a part of the readings are laid; the best of
them refined (:mod:`robotd.localization.fit.refinement`) within the box; and the count of the readings that this pose
explains ([BrownDonald2000]_ sec. 2.2.1, but at a point, not at a cell), which decides whether the robot is there at
all. Heads know nothing of what lies on the way to them, so they may come to lie on the back of a thin wall. Then the
pose explains too few readings, or leaves too great a residual, to be settled, and rivals on the lattice are refined,
too: the one that explains the most is the answer.

With 300 readings and 0.3 m, 10 degrees that takes some 0.15 ms if it is settled at once, else 0.5 ms; counting feasible
poses in the same box takes 0.3 ms, and its best cell has to be refined all the same.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.grid import kernels
from robotd.grid.kernels.cast.cast_kernel import REACH_CELLS
from robotd.grid.kernels.fit.fit_kernel import Lattice
from robotd.grid.readings import Readings
from robotd.grid.wall_field import WallField
from robotd.localization.fit.refinement import DISTANCES, Heads, PoseBox, RefinedPoses, ranges_along, refine_heads
from robotd.localization.fit.refinement_settings import RefinementSettings


@dataclass(frozen=True, slots=True)
class TrackingSettings:
    """How a pose is found near a prior, and what it must explain."""

    step_cells: int = 2
    """Step of the lattice along x and y, in cells; more than a few leave the right pose out of reach."""
    step_rad: float = 0.044
    """Step of its headings."""
    heads: int = 50
    """About this many readings, evenly chosen, decide on the lattice."""
    explained_within_m: float = 0.1
    """A reading is explained only if a wall is so near to its head..."""
    unblocked_within_m: float = 0.2
    """...and none on its way, unless so near to its end. With 0.1 m beams that graze walls went missing by the dozen in
    two real buildings; with 0.2 m and ``blocked_by`` 2 the right pose explained 64 to 99 % of the readings, the best
    one within 0.3 m of a place 2 m off at most 57 %."""
    blocked_by: int = 2
    """How many cells a beam must meet to be stopped, 1 or 2; 2 lets it graze along a wall."""
    settled_share: float = 0.87
    """A pose that explains this share of the readings..."""
    settled_residual_m: float = 0.03
    """...and leaves no greater residual has no rival..."""
    rivals: int = 6
    """...else this many more are tried."""
    here_share: float = 0.6
    """Share of the readings that must be explained; else the robot is not here."""
    readings_min: int = 12
    """With fewer readings than this it is nowhere."""

    def __post_init__(self) -> None:
        """Refuse impossible values."""
        for name, number, least in (
            ("step_cells", self.step_cells, 1),
            ("heads", self.heads, 1),
            ("rivals", self.rivals, 0),
            ("readings_min", self.readings_min, 1),
        ):
            if number < least:
                raise ValueError(f"{name} must be at least {least}, got {number}")
        for name, value in (
            ("step_rad", self.step_rad),
            ("explained_within_m", self.explained_within_m),
            ("unblocked_within_m", self.unblocked_within_m),
            ("settled_residual_m", self.settled_residual_m),
        ):
            if not value > 0.0:
                raise ValueError(f"{name} must be positive, got {value}")
        for name, share in (("settled_share", self.settled_share), ("here_share", self.here_share)):
            if not 0.0 < share <= 1.0:
                raise ValueError(f"{name} must lie in (0, 1], got {share}")
        if self.blocked_by not in (1, 2):
            raise ValueError(f"blocked_by must be 1 or 2, got {self.blocked_by}")


@dataclass(frozen=True, slots=True, eq=False)
class Tracked:
    """The robot is here."""

    pose: Pose2
    """Map frame."""
    covariance: NDArray[np.float64]
    """``float64[3, 3]`` of x, y [m] and heading [rad]."""
    residual_m: float
    """How far the heads lie from the walls: root of their weighted mean square."""
    explained_share: float
    """Share of the readings, hits and misses, that the pose explains."""
    explained: NDArray[np.bool_]
    """``bool[m]``: which."""


@dataclass(frozen=True, slots=True, eq=False)
class NotHere:
    """The robot is not within the prior box, or cannot be told to be."""

    best: Tracked | None = None
    """The pose in it that explains the most all the same; None where there were too few readings to look."""

    @property
    def explained_share(self) -> float:
        """Share of the readings that the best pose explains."""
        return 0.0 if self.best is None else self.best.explained_share

    @property
    def residual_m(self) -> float:
        """How far the heads lie from the walls there."""
        return math.inf if self.best is None else self.best.residual_m


def track(
    field: WallField,
    readings: Readings,
    prior: PoseBox,
    settings: TrackingSettings,
    refinement: RefinementSettings,
) -> Tracked | NotHere:
    """Find the robot within a prior box.

    Args:
        field: the map.
        readings: ``m`` hits and misses, one sweep.
        prior: where it may be; the lattice begins at its start.
        settings: how to look, and what is enough.
        refinement: how to refine.

    O(poses of the lattice x heads + m).
    """
    heads = Heads.of(readings, field.spec.resolution_m)
    if len(readings) < settings.readings_min or len(heads.at_cells) == 0:
        return NotHere()
    search = _Search(field, readings, heads, prior, settings, refinement)
    starts = search.starts()
    # One first: where it is settled that is all, in a third of the time.
    best = search.best_of([next(starts)])
    settled = best.share >= settings.settled_share and best.residual_m <= settings.settled_residual_m
    # Starts are drawn from the lattice one by one, so a pose that is settled at once never pays for rivals.
    rivals = [] if settled else list(islice(starts, settings.rivals))
    if rivals:
        best = max(best, search.best_of(rivals), key=attrgetter("share"))
    pose, covariance = best.poses.pose(best.number), best.poses.covariances[best.number]
    found = Tracked(pose, covariance, best.residual_m, best.share, best.explained)
    return found if best.share >= settings.here_share else NotHere(found)


@dataclass(frozen=True, slots=True, eq=False)
class _Candidate:
    """One of some refined poses."""

    poses: RefinedPoses
    number: int
    share: float
    explained: NDArray[np.bool_]

    @property
    def residual_m(self) -> float:
        return float(self.poses.residual_m[self.number])


@dataclass(frozen=True, slots=True, eq=False)
class _Search:
    """What is looked for, where and how."""

    field: WallField
    readings: Readings
    heads: Heads
    prior: PoseBox
    settings: TrackingSettings
    refinement: RefinementSettings

    def starts(self) -> Iterator[Pose2]:
        """Return the best poses of the lattice, best first, each two steps or more from all before it."""
        start, lattice = self.prior.start, self._lattice()
        heads = self.heads.at_cells
        # Evenly round, so that no wall decides alone; fifty tell the right hill, and all readings find its top.
        part = np.ascontiguousarray(heads[:: max(1, len(heads) // self.settings.heads)])
        costs, turns = kernels.in_use().fit.scan_poses(self.field.codes, _COSTS[self.refinement.walls], part, lattice)
        step_m, wide = lattice.step_cells * self.field.spec.resolution_m, costs.shape[1]
        for _ in range(costs.size):
            row, col = divmod(int(costs.argmin()), wide)
            # All that is left lies beside a start that was given: there are fewer starts than places.
            if costs[row, col] == _TAKEN:
                return
            yield Pose2(
                start.x_m + (col + int(lattice.steps[0])) * step_m,
                start.y_m + (row + int(lattice.steps[2])) * step_m,
                start.heading_rad + int(turns[row, col]) * lattice.step_rad,
            )
            # Its neighbours are the same hill, which refinement will climb from any side.
            costs[max(0, row - 1) : row + 2, max(0, col - 1) : col + 2] = _TAKEN

    def best_of(self, starts: Sequence[Pose2]) -> _Candidate:
        """Refine poses; return the one that then explains most readings, the first of equal ones."""
        boxes = [replace(self.prior, start=start) for start in starts]
        poses = refine_heads(self.field, self.heads, boxes, self.refinement)
        explained = self._explained(poses)
        counts = explained.sum(axis=1)
        number = int(counts.argmax())
        return _Candidate(poses, number, int(counts[number]) / len(self.readings), explained[number])

    def _lattice(self) -> Lattice:
        spec, bounds, start = self.field.spec, self.prior.bounds, self.prior.start
        step_m, step_rad = self.settings.step_cells * spec.resolution_m, self.settings.step_rad
        sides = (
            *_steps(start.x_m, bounds.x_min_m, bounds.x_max_m, step_m),
            *_steps(start.y_m, bounds.y_min_m, bounds.y_max_m, step_m),
            *_steps(start.heading_rad, bounds.heading_min_rad, bounds.heading_max_rad, step_rad),
        )
        x, y = (start.x_m - spec.origin_x_m) / spec.resolution_m, (start.y_m - spec.origin_y_m) / spec.resolution_m
        at = np.array((x, y, start.heading_rad))
        return Lattice(at, np.array(sides, np.int32), self.settings.step_cells, step_rad)

    def _explained(self, poses: RefinedPoses) -> NDArray[np.bool_]:
        """Return which readings each pose explains, ``bool[n, m]``."""
        settings = self.settings
        ways_m = ranges_along(self.field, self.heads.beams, poses.poses, settings.blocked_by).ranges_m
        explained: NDArray[np.bool_] = ways_m >= self.readings.range_m - settings.unblocked_within_m
        # Misses have NaN here, which compares as false: nothing is asked of a head that they lack.
        explained &= ~(np.abs(poses.beyond_m) > settings.explained_within_m)
        return explained


def _steps(start: float, low: float, high: float, step: float) -> tuple[int, int]:
    """Return the first and the last step of a lattice within half a step of all between the bounds."""
    first = round((low - start) / step)
    return first, max(first, round((high - start) / step))


def _costs(distances: NDArray[np.float64]) -> NDArray[np.int32]:
    """Return Tukey's cost of a head by code, ``int32[256]``, in thousandths of that of a head far from any wall."""
    left = np.maximum(1.0 - (distances / REACH_CELLS) ** 2, 0.0)
    # Whole numbers, so that sums over the heads come out the same in any order.
    return np.rint(1000.0 * (1.0 - left**3)).astype(np.int32)


_TAKEN = int(np.iinfo(np.int32).max)
_COSTS = {walls: _costs(distances) for walls, distances in DISTANCES.items()}
