"""What arguments may be: bounds that a robot can have, and poses as clients write them."""

import math
from typing import Annotated

import msgspec
from msgspec import Meta

from robotd.core.pose import Pose2

Coordinate = Annotated[float, Meta(ge=-100_000.0, le=100_000.0)]
Heading = Annotated[float, Meta(ge=-2.0 * math.pi, le=2.0 * math.pi)]
"""A whole turn either way: clients count from -pi to pi or from 0 to 2 pi, and who takes it wraps it."""
LeaseTime = Annotated[float, Meta(ge=0.1, le=10.0)]
# \A and \Z: with ^ and $ a newline at the end would pass, and a name becomes a directory.
MapName = Annotated[str, Meta(pattern=r"\A[A-Za-z0-9][A-Za-z0-9._-]{0,63}\Z")]
RecordingPath = Annotated[str, Meta(min_length=1, max_length=1024, pattern=r"\A[^\x00]*\Z")]
Slope = Annotated[float, Meta(ge=-1.4, le=1.4)]
"""Up from level; as of the setting ``sweep.tilt_rad``."""
CutOff = Annotated[float, Meta(gt=0.0, le=200.0)]
Number = Annotated[int, Meta(ge=0, le=2**53)]
"""Up to which whole numbers are exact in languages that have doubles alone."""
Stops = Annotated[tuple[tuple[Coordinate, Coordinate], ...], Meta(max_length=1000)]


class PoseArgument(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A pose in the map frame, as an argument."""

    x_m: Coordinate
    y_m: Coordinate
    heading_rad: Heading = 0.0

    @property
    def pose(self) -> Pose2:
        """The same, as the rest of the house writes it."""
        return Pose2(self.x_m, self.y_m, self.heading_rad)

    @classmethod
    def of(cls, pose: Pose2) -> "PoseArgument":
        """Return a pose as an argument."""
        return cls(pose.x_m, pose.y_m, pose.heading_rad)


class TiltArgument(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A further tilt to look at, as an argument."""

    tilt_rad: Slope
    cut_off_m: CutOff | None = None
    """What is horizontally farther counts as not met; that of the rangefinder if none is said."""


Tilts = Annotated[tuple[TiltArgument, ...], Meta(max_length=8)]
