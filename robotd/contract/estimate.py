"""What the daemon says about where the robot is: a state and its regions, never a bare guess."""

import enum
import math
from dataclasses import dataclass, field

from robotd.contract.walls_verdict import WallsVerdict
from robotd.core.angles import wrap_rad
from robotd.core.pose import Pose2


class PoseState(enum.StrEnum):
    """How much the estimate can be trusted."""

    LOST = "lost"
    """No pose explains enough of the readings, or they are rather those of somewhere else."""
    AMBIGUOUS = "ambiguous"
    """Several places explain them about as well, or one that nothing holds at its place."""
    LOCALIZED = "localized"
    """One place, and hardly a doubt about it."""
    PREDICTED = "predicted"
    """Carried forward by odometry since it was last localized."""


class Contradiction(enum.StrEnum):
    """Why none of the places that a look leaves can be reached from where the robot was."""

    CARRIED = "carried"
    """They are farther off than wheels err: somebody carried it, or it was never there."""
    SLIPPED = "slipped"
    """They are near to where it should be: the wheels erred by more than they may."""


@dataclass(frozen=True, slots=True)
class Extent:
    """How far a region reaches, outer edges, map frame."""

    x_min_m: float
    x_max_m: float
    y_min_m: float
    y_max_m: float
    heading_min_rad: float
    """In ``[-pi, pi)``."""
    heading_max_rad: float
    """Counter-clockwise from the least, so never less, and up to a whole turn more."""

    def holds(self, pose: Pose2, *, near_m: float = 0.0, near_rad: float = 0.0) -> bool:
        """Return whether a pose lies within, if its sides are moved outward by ``near_m`` and ``near_rad``."""
        beside_m = max(self.x_min_m - pose.x_m, pose.x_m - self.x_max_m)
        above_m = max(self.y_min_m - pose.y_m, pose.y_m - self.y_max_m)
        # From the middle: the headings may run across pi, where ends cannot be compared.
        middle_rad = (self.heading_min_rad + self.heading_max_rad) / 2
        turned_rad = abs(wrap_rad(pose.heading_rad - middle_rad)) - (self.heading_max_rad - middle_rad)
        return max(beside_m, above_m) <= near_m and turned_rad <= near_rad


@dataclass(frozen=True, slots=True)
class Circle:
    """The smallest circle that holds a region's cells, map frame."""

    x_m: float
    y_m: float
    radius_m: float


@dataclass(frozen=True, slots=True)
class Cover:
    """The cells of a region, row by row; of a large and ragged region coarser blocks that hold all of its cells."""

    block_cells: int
    """Cells along the side of a block: 1, so that blocks are cells of the map, or a power of two."""
    runs: tuple[tuple[int, int, int], ...]
    """``(row, first column, last column)`` of blocks side by side, ascending; block ``(r, c)`` holds the cells of rows
    ``r * block_cells`` and on, columns ``c * block_cells`` and on."""


Row = tuple[float, float, float]
Covariance = tuple[Row, Row, Row]


@dataclass(frozen=True, slots=True)
class Region:
    """A connected set of poses, all of high rank: one answer to *where*."""

    belief: float
    """Share of the belief that the second look gives to what lies in it."""
    pose: Pose2
    """Where in it the readings fit best, below the size of a cell, map frame."""
    covariance: Covariance = field(repr=False)
    """Of x, y [m] and heading [rad] of ``pose``, by rows: what is left of its error, the map's own included."""
    residual_m: float
    """How far the readings' ends lie from the walls at ``pose``: root of the weighted mean square."""
    centre: Pose2
    """Mean of its poses of greatest rank, map frame."""
    extent: Extent
    circle: Circle
    cover: Cover = field(repr=False)
    cells: int
    """Cells of the map that it holds."""
    poses: int
    """Cells, each counted with every heading."""
    best_rank: int
    """Readings explained at its best poses."""
    explained: tuple[bool, ...] = field(repr=False)
    """Whether its best pose explains each reading, in the order of the estimate's ``bearings_rad``; that pose is one of
    greatest rank, and of these the one nearest to the centre."""


@dataclass(frozen=True, slots=True)
class Ends:
    """Where the readings end, seen from the best place: shares of what they say, which add up to 1."""

    as_mapped: float
    """On walls of the map, or beyond its cut-off with nothing of the map in the way."""
    unseen: float
    """Where nobody has looked: new ground."""
    against_map: float
    """Where the map shows no obstacle, or behind one."""


@dataclass(frozen=True, slots=True)
class LayerSaid:
    """What a further layer of the map said of the answers."""

    tilt_rad: float
    readings: int
    """Made at its tilt."""
    best_rank: int
    """How many of them it explains at best at one of the poses that were left; 0 where it has seen none of these."""

    def __str__(self) -> str:
        """Say it for people."""
        return f"{self.best_rank} of {self.readings} at {math.degrees(self.tilt_rad):.1f} deg"


@dataclass(frozen=True, slots=True)
class PoseEstimate:
    """A pose estimate as served to clients."""

    time_ns: int
    """When the robot was there, monotonic clock of this host [ns]."""
    state: PoseState
    best: Pose2 | None
    """The pose, map frame; only when it is unique (``localized`` or ``predicted``)."""
    regions: tuple[Region, ...]
    """The answers that remain, best first; one when ``localized``, none when ``lost`` or ``predicted``."""
    best_rank: int
    """Readings explained at the best cells (the paper's kappa); 0 if no pose explains enough to be an answer."""
    readings: int
    """Readings it is built from (the paper's m)."""
    final: bool
    """False while the sweep it is built from is still under way."""
    map_id: str
    """Which map it speaks of."""
    regions_left_out: int = 0
    """Further regions, none better than those listed."""
    belief_aside: float = 0.0
    """Share of what lies a little to the side of the best place, where nothing holds the pose, as along a corridor."""
    belief_nowhere: float = 0.0
    """Share of being nowhere on this map."""
    contrast: float | None = None
    """Least contrast of the best place with any elsewhere on the map, in standard errors; None if there is no other."""
    bearings_rad: tuple[float, ...] = field(default=(), repr=False)
    """Directions of the readings it is built from, robot frame, in the order in which they were made."""
    jumped_m: float | None = None
    """How far the first region lies from where odometry puts the robot, if that is farther than odometry errs: then the
    state is ``ambiguous`` until another look agrees. Else None."""
    complete: bool = True
    """Whether every pose was looked at that may be the answer; not where the budget of the search ran out, or where
    there were too many to tell. Then the state is ``ambiguous``."""
    ends: Ends | None = None
    """How much of the sweep the map knows at the best place that was weighed, whatever the state; None without one."""
    in_odom: Pose2 | None = None
    """Where odometry placed the robot at ``time_ns``, or where the sweep began that this is built from; None if that is
    not known."""
    map_from_odom: Pose2 | None = None
    """How the odometry frame lies on the map, once this estimate is taken into account; None while nothing ties them
    that is believed."""
    mission_id: int | None = None
    """Of the mission that looked round; None if odometry predicted it."""
    sweep: int | None = None
    """Number of the sweep that it is built from; None if odometry predicted it."""
    by_history: bool = False
    """Whether it is ``localized`` because the robot can have come to no other of the places that the readings leave."""
    unreachable: int = 0
    """Places that the readings leave, too, but to which the robot cannot have come; they are not among the regions."""
    contradiction: Contradiction | None = None
    """Why the robot can have come to none of them, if so: then the state is ``ambiguous`` until another look agrees."""
    walls: WallsVerdict | None = None
    """What walls said of the heading; None where they were not asked."""
    smallest_error_m: float | None = None
    """The least error radius at which nine of ten readings agree on some pose of the best answer's heading; None where
    that was not asked for, or none is large enough."""
    layers: tuple[LayerSaid, ...] = ()
    """What each further layer said, in the order in which they were asked; none unless the robot looked at its tilt."""

    def __str__(self) -> str:
        """Say in one line what people ask first."""
        explained = f"{self.best_rank} of {self.readings} readings explained"
        if self.best is not None:
            heading_deg = math.degrees(self.best.heading_rad)
            where = f" at x {self.best.x_m:.3f} m, y {self.best.y_m:.3f} m, heading {heading_deg:.1f} deg"
            return f"{self.state}{where}; {explained}"
        places = len(self.regions) + self.regions_left_out
        return f"{self.state}{f': {places} places' if places else ''}; {explained}"
