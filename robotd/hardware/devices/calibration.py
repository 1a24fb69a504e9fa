"""What it takes to get from what the instruments say to metres and radians."""

import math
from dataclasses import dataclass
from typing import Annotated

from robotd.core.bounds import Within, refuse_outside

# Wide enough for any robot, narrow enough that most values in a wrong unit fall outside (decision 23).
CountsPerM = Annotated[float, Within(100.0, 1e8, "counts/m", either_sign=True)]
CountsPerRad = Annotated[float, Within(10.0, 1e8, "counts/rad", either_sign=True)]
Offset = Annotated[float, Within(-3.0, 3.0, "m")]
Reach = Annotated[float, Within(-1.0, 1.0, "m")]
Zero = Annotated[float, Within(-math.pi, math.pi, "rad")]
Height = Annotated[float, Within(0.0, 3.0, "m")]
Play = Annotated[float, Within(0.0, 0.5, "rad")]
Bias = Annotated[float, Within(-1.0, 1.0, "m")]
Nearest = Annotated[float, Within(0.001, 20.0, "m")]
Farthest = Annotated[float, Within(0.05, 200.0, "m")]


@dataclass(frozen=True, slots=True)
class DriveCalibration:
    """Scales of the two encoders; a negative one turns the sense of its encoder round."""

    counts_per_m: CountsPerM
    """Translation encoder counts per metre along the heading."""
    counts_per_rad: CountsPerRad
    """Rotation encoder counts per radian counter-clockwise."""

    def __post_init__(self) -> None:
        """Refuse scales that say nothing."""
        refuse_outside(self)


@dataclass(frozen=True, slots=True)
class HeadMount:
    """Where the head sits on the robot, and what it calls straight ahead and level."""

    x_m: Offset = 0.0
    """Pan axis in the robot frame, ahead of the centre."""
    y_m: Offset = 0.0
    """Pan axis in the robot frame, to the left of the centre."""
    pan_zero_rad: Zero = 0.0
    """Added to the pan that the head reads back, to get the angle from the robot's heading."""
    tilt_zero_rad: Zero = 0.0
    """Added to the tilt that the head reads back, to get the angle up from level."""
    backlash_rad: Play = 0.0
    """Play of the pan gears, which no readback shows: in a sweep the beam lags behind its motor by half of it."""
    height_m: Height = 0.0
    """Of the level beam above the floor; 0 if nobody measured it."""
    lens_ahead_m: Reach = 0.0
    """How far ahead of both axes the beam leaves the head; it turns with the head."""
    lens_up_m: Reach = 0.0
    """How far above the tilt axis it does, when the head looks level."""

    def __post_init__(self) -> None:
        """Refuse what cannot be a mount."""
        refuse_outside(self)


@dataclass(frozen=True, slots=True)
class RangefinderCalibration:
    """What the instrument can be believed."""

    range_bias_m: Bias = 0.0
    """Added to every range along the beam."""
    range_min_m: Nearest = 0.3
    """Shortest range along the beam that the instrument measures rightly; LILY's is 0.3 m."""
    range_max_m: Farthest = 6.0
    """Cut-off: what is horizontally farther than this counts as not met; LILY's is 6 m."""

    def __post_init__(self) -> None:
        """Refuse ranges that leave nothing to measure."""
        refuse_outside(self)
        if not self.range_min_m < self.range_max_m:
            raise ValueError(f"range_max_m must be above range_min_m, got {self.range_max_m} and {self.range_min_m}")
