"""How a sweep is taken."""

from dataclasses import dataclass
from typing import Annotated

from robotd.core.bounds import Within, refuse_outside


@dataclass(frozen=True, slots=True)
class SweepSettings:
    """How a sweep is taken."""

    readings: Annotated[int, Within(1, 10_000)] = 300
    """Readings evenly round the robot."""
    tilt_rad: Annotated[float, Within(-1.4, 1.4, "rad")] = 0.0
    """Tilt of the beam, up from level; LILY slanted hers to the floor 2 m ahead. The cut-off (``range_max_m``) must lie
    before the floor, or the floor is taken for walls."""
    settle_s: Annotated[float, Within(0.01, 60.0, "s")] = 0.2
    """Odometry must report standstill for so long before the first reading."""
    aim_timeout_s: Annotated[float, Within(0.01, 120.0, "s")] = 5.0
    """Longest time one turn of the head may take."""
    shot_timeout_s: Annotated[float, Within(0.01, 60.0, "s")] = 1.0
    """Longest time one measurement may take."""
    readings_min_share: Annotated[float, Within(0.0, 1.0, "of 1")] = 0.5
    """Share of the readings that the rangefinder must answer: when more fail (too weak, too bright, silent), the sweep
    is given up."""
    resets: Annotated[int, Within(0, 10)] = 2
    """How often a head that lost steps is reset, and the sweep taken again, before the mission is given up."""

    def __post_init__(self) -> None:
        """Refuse what cannot be swept."""
        refuse_outside(self)
