"""The robot as the planner sees it."""

from dataclasses import dataclass
from typing import Annotated

from robotd.core.bounds import Within, refuse_outside


@dataclass(frozen=True, slots=True)
class PlanningSettings:
    """The robot as the planner sees it."""

    robot_radius_m: Annotated[float, Within(0.02, 3.0, "m")] = 0.3
    """Radius of the disk that the robot fills."""
    clearance_m: Annotated[float, Within(0.0, 2.0, "m")] = 0.1
    """What to keep free round it for errors of the drive and of the map; the rounding to cells is seen to besides."""
    gap_cells: Annotated[int, Within(0, 20, "cells")] = 2
    """Unknown gaps up to so wide, between cells seen free, are taken for free."""

    keeps_bumps: bool = True
    """Whether a place where the robot bumped into something is an obstacle from then on, whatever the laser sees."""

    def __post_init__(self) -> None:
        """Refuse impossible values."""
        refuse_outside(self)
