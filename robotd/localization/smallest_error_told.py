"""Beside an answer: how far its readings must be trusted, so that nearly all of them agree on one pose.

The varying-epsilon method of [BrownDonald2000]_ sec. 2.2.1, at the heading of the best answer: not how many readings a
given error explains, but which error explains a given share. Where the rank says that some readings are not explained,
this says by how much.
"""

from dataclasses import dataclass, field, replace

from robotd.contract.estimate import PoseEstimate
from robotd.core.reading import RangeReading, Slant
from robotd.localization.count.heat import Heat
from robotd.localization.erring.error_map import ErrorMap
from robotd.localization.erring.share_errors import errors_on
from robotd.localization.estimator import Estimator
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.ready_map import ReadyMap

AGREEING_SHARE = 0.9
"""Of the readings, as in the paper's example."""


@dataclass(frozen=True, slots=True, eq=False)
class SmallestErrorTold:
    """Another estimator, which tells the smallest error of a whole sweep, too."""

    estimator: Estimator
    the_map: ReadyMap
    threads: int
    readings: list[RangeReading] = field(default_factory=list)

    def add(self, *readings: RangeReading) -> None:
        """Take measured readings, hits or misses.

        Raises:
            ValueError: a reading measured nothing; then none is taken.
        """
        self.estimator.add(*readings)
        self.readings.extend(readings)

    def add_slants(self, *slants: Slant) -> None:
        """Take what was seen at the tilts of the map's layers: of the error nothing is asked there."""
        self.estimator.add_slants(*slants)

    def estimate(self, time_ns: int, *, final: bool) -> PoseEstimate:
        """Return what the readings so far say; of a whole sweep with an answer its smallest error too, O(cells)."""
        estimate = self.estimator.estimate(time_ns, final=final)
        if not final or not estimate.regions:
            return estimate
        return replace(estimate, smallest_error_m=self._smallest_m(estimate.regions[0].pose.heading_rad))

    def heat(self) -> Heat | None:
        """Return the picture that the other has."""
        return self.estimator.heat()

    def _smallest_m(self, heading_rad: float) -> float | None:
        the_map, settings = self.the_map, self.the_map.settings
        obstacles = Obstacles.of_map(the_map.ternary, settings.unknown, 0.0, blocked_by=settings.blocked_by)
        errors = errors_on(
            ErrorMap.of(obstacles, the_map.spec), self.readings, heading_rad, AGREEING_SHARE, threads=self.threads
        )
        least = float(errors.min())
        return least * the_map.spec.resolution_m if least < float("inf") else None
