"""What the daemon says about where the robot is: a state and all regions, never a bare guess."""

import enum
from dataclasses import dataclass

from robotd.core.pose import Pose2


class PoseState(enum.StrEnum):
    """How much the estimate can be trusted."""

    LOST = "lost"
    """No pose explains enough of the readings."""
    AMBIGUOUS = "ambiguous"
    """Several separate regions explain them about as well, or one that is too wide to be called a place."""
    LOCALIZED = "localized"
    """One region only."""
    PREDICTED = "predicted"
    """Carried forward by odometry since it was last localized."""


@dataclass(frozen=True, slots=True)
class Region:
    """A connected set of cells, all of high rank: one answer to *where*."""

    centre: Pose2
    """Mean of its cells of greatest rank, map frame."""
    x_min_m: float
    x_max_m: float
    y_min_m: float
    y_max_m: float
    """Extent of its cells, outer edges, map frame."""
    cells: int
    best_rank: int
    """Readings explained at its best cells."""


@dataclass(frozen=True, slots=True)
class PoseEstimate:
    """A pose estimate as served to clients."""

    time_ns: int
    """When the robot was there, monotonic clock of this host [ns]."""
    state: PoseState
    best: Pose2 | None
    """The pose, map frame; only when it is unique (``localized`` or ``predicted``)."""
    regions: tuple[Region, ...]
    """All of them, best first; empty when ``lost`` or ``predicted``."""
    best_rank: int
    """Readings explained at the best cells (the paper's kappa)."""
    readings: int
    """Readings it is built from (the paper's m)."""
    final: bool
    """False while the sweep it is built from is still under way."""
    map_id: str
    """Which map it speaks of."""
