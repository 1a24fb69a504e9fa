"""From readings to a pose estimate: feasible poses counted, the best regions found, their uniqueness judged.

The consistent reading method of [BrownDonald2000]_ sec. 2.2.1: look for the poses that explain the most readings. It
bears bad readings and obstacles that are not on the map (fig. 6), and it does not hide that several places look alike.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from robotd.core.reading import RangeReading
from robotd.grid.binary import BinaryMap
from robotd.localization.estimate import PoseEstimate, PoseState, Region
from robotd.localization.prepared import PreparedMap
from robotd.localization.rank import RankGrid, even_headings
from robotd.localization.regions import regions_of


@dataclass(frozen=True, slots=True)
class LocalizationSettings:
    """What counts as explained, and what as an answer.

    The defaults were chosen on simulated rooms and on two real buildings (5 cm cells, 120 kept-out scans each): the
    true pose explained 75 to 90 % of the readings, the best pose in a building where the robot was not 17 to 69 %.
    """

    range_error_m: float = 0.075
    """The paper's eps: how far an obstacle on the map may lie from the head of a reading."""
    heading_error_rad: float = 0.0175
    """How far the heading that odometry gives may be off: headings up to so far away are tried too."""
    heading_step_rad: float = 0.00875
    """Step between the headings that are tried."""
    localized_share: float = 0.5
    """Share of the readings that the best pose must explain; below it the robot is lost."""
    rival_share: float = 0.15
    """A pose is still an answer if it explains fewer readings than the best by no more than this share of all."""
    unique_within_m: float = 0.5
    """The pose is unique if all answers lie this near to the best: no rival elsewhere, no region a corridor long."""
    readings_min: int = 12
    """With fewer readings than this nothing is said."""

    def __post_init__(self) -> None:
        """Refuse impossible values."""
        if not self.range_error_m >= 0.0:
            raise ValueError(f"range_error_m must not be negative, got {self.range_error_m}")
        if not self.heading_error_rad >= 0.0:
            raise ValueError(f"heading_error_rad must not be negative, got {self.heading_error_rad}")
        if not self.heading_step_rad > 0.0:
            raise ValueError(f"heading_step_rad must be positive, got {self.heading_step_rad}")
        if not 0.0 < self.localized_share <= 1.0:
            raise ValueError(f"localized_share must lie in (0, 1], got {self.localized_share}")
        if not 0.0 <= self.rival_share < 1.0:
            raise ValueError(f"rival_share must lie in [0, 1), got {self.rival_share}")
        if not self.unique_within_m > 0.0:
            raise ValueError(f"unique_within_m must be positive, got {self.unique_within_m}")
        if self.readings_min < 1:
            raise ValueError(f"readings_min must be at least 1, got {self.readings_min}")

    def headings_near(self, heading_rad: float) -> tuple[float, ...]:
        """Return the headings to try when odometry says ``heading_rad``, in ascending order.

        >>> LocalizationSettings(heading_error_rad=0.2, heading_step_rad=0.1).headings_near(1.0)
        (0.8, 0.9, 1.0, 1.1, 1.2)
        """
        steps = math.floor(self.heading_error_rad / self.heading_step_rad + 1e-9)
        return tuple(heading_rad + step * self.heading_step_rad for step in range(-steps, steps + 1))

    def headings_all_round(self) -> tuple[float, ...]:
        """Return the headings to try when nothing is known, evenly all round, in steps no longer than the setting."""
        return even_headings(math.ceil(math.tau / self.heading_step_rad - 1e-9))


class Localizer:
    """Localizes on one map, stop after stop; an estimate may be asked for after any reading."""

    def __init__(self, binary: BinaryMap, settings: LocalizationSettings, map_id: str, *, threads: int = 1) -> None:
        """Prepare for a map.

        Args:
            binary: the map.
            settings: what counts as an answer.
            map_id: what estimates call the map.
            threads: how many threads may share the work when it is much; no estimate depends on it.
        """
        self._threads = threads
        self._map = PreparedMap.of_binary(binary, settings.range_error_m / binary.spec.resolution_m)
        self._settings = settings
        self._map_id = map_id
        self._ranks = self._blank((0.0,))

    @property
    def ranks(self) -> RankGrid:
        """The count so far: for pictures, and for whoever wants more than the estimate."""
        return self._ranks

    def begin(self, headings_rad: Sequence[float]) -> None:
        """Forget the readings of the last stop.

        Args:
            headings_rad: the robot's possible headings in the map frame; one if odometry knows it.
        """
        self._ranks = self._blank(headings_rad)

    def add(self, *readings: RangeReading) -> None:
        """Count measured readings, hits or misses; many at once cost less than one after the other.

        Raises:
            ValueError: a reading measured nothing; then none is counted.
        """
        self._ranks.add(*readings)

    def estimate(self, time_ns: int, *, final: bool) -> PoseEstimate:
        """Return what the readings so far say.

        Args:
            time_ns: when the robot was there.
            final: whether the sweep is whole.
        """
        state, regions = self._judge()
        return PoseEstimate(
            time_ns=time_ns,
            state=state,
            best=regions[0].centre if state is PoseState.LOCALIZED else None,
            regions=regions,
            best_rank=self._ranks.best_rank,
            readings=self._ranks.readings,
            final=final,
            map_id=self._map_id,
        )

    def _judge(self) -> tuple[PoseState, tuple[Region, ...]]:
        settings, best_rank, readings = self._settings, self._ranks.best_rank, self._ranks.readings
        if readings < settings.readings_min or best_rank < settings.localized_share * readings:
            return PoseState.LOST, ()
        slack = math.ceil(settings.rival_share * readings)
        regions = regions_of(self._ranks, max(1, best_rank - slack))
        spread_m = max(_farthest_m(region, regions[0]) for region in regions)
        return (PoseState.LOCALIZED if spread_m <= settings.unique_within_m else PoseState.AMBIGUOUS), regions

    def _blank(self, headings_rad: Sequence[float]) -> RankGrid:
        return RankGrid(self._map, headings_rad, threads=self._threads)


def _farthest_m(region: Region, best: Region) -> float:
    """Return how far the box round a region reaches from the centre of the best one."""
    x_m, y_m = best.centre.x_m, best.centre.y_m
    return math.hypot(
        max(region.x_max_m - x_m, x_m - region.x_min_m),
        max(region.y_max_m - y_m, y_m - region.y_min_m),
    )
