"""The seam for another estimator: what the mission asks of whatever says where the robot is."""

from typing import Protocol

from robotd.contract.estimate import PoseEstimate
from robotd.core.reading import RangeReading, Slant
from robotd.localization.count.heat import Heat


class Estimator(Protocol):
    """Says where the robot is, from the readings of one stop; may be asked after any of them.

    It works on one thread at a time. What it says depends on the readings alone, or recordings would not replay.
    """

    def add(self, *readings: RangeReading) -> None:
        """Take measured readings, hits or misses.

        Raises:
            ValueError: a reading measured nothing; then none is taken.
        """

    def add_slants(self, *slants: Slant) -> None:
        """Take what was seen at the tilts of the map's layers."""

    def estimate(self, time_ns: int, *, final: bool) -> PoseEstimate:
        """Return what the readings so far say.

        Args:
            time_ns: when the robot was there.
            final: whether the sweep is whole.
        """

    def heat(self) -> Heat | None:
        """Return a picture of how many readings each place explains; None if it has none to show."""
