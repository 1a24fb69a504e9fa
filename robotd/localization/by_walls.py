"""Where nothing is known of the heading: first the headings that walls name, then all.

Separated orientation ([BrownDonald2000]_ sec. 2.2.3), and what is done where it does not hold: where walls name no
heading, or headings that explain nothing, the answer is that of all headings. What is left is its own failure: walls
with an axis of their own, as a room of slanted furniture has. Then other headings than the true one are tried, and a
place that explains the readings under one of them has no rival at the true one.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from weakref import WeakKeyDictionary

from robotd.contract.area import Area
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.walls_verdict import WallsVerdict
from robotd.core.reading import RangeReading, Slant
from robotd.localization.count.heat import Heat
from robotd.localization.localizer import Localizer
from robotd.localization.orientation.separated_orientation import (
    Axis,
    OrientationSettings,
    map_axis,
    separated_orientation,
)
from robotd.localization.ready_map import ReadyMap

_SETTINGS = OrientationSettings()


@dataclass(frozen=True, slots=True, eq=False)
class ByWalls:
    """Localizes at one stop by the headings that walls name: an :class:`~robotd.localization.estimator.Estimator`."""

    everywhere: Localizer
    """Under all headings."""
    within: Area | None
    threads: int
    readings: list[RangeReading] = field(default_factory=list)

    def add(self, *readings: RangeReading) -> None:
        """Take measured readings, hits or misses.

        Raises:
            ValueError: a reading measured nothing; then none is taken.
        """
        self.everywhere.add(*readings)
        self.readings.extend(readings)

    def add_slants(self, *slants: Slant) -> None:
        """Take what was seen at the tilts of the map's layers."""
        self.everywhere.add_slants(*slants)

    def estimate(self, time_ns: int, *, final: bool) -> PoseEstimate:
        """Return what the readings so far say, and what the walls said of the heading."""
        step_rad = self.everywhere.the_map.settings.heading_step_rad
        found = separated_orientation(self.readings, _axis_of(self.everywhere.the_map), _SETTINGS)
        verdict = found.verdict
        if verdict is WallsVerdict.USABLE:
            estimate = self._under(found.headings_near(step_rad, _SETTINGS)).estimate(time_ns, final=final)
            if estimate.state is not PoseState.LOST:
                return replace(estimate, walls=verdict)
            verdict = WallsVerdict.NO_POSE
        return replace(self.everywhere.estimate(time_ns, final=final), walls=verdict)

    def heat(self) -> Heat:
        """Return how many of the readings so far each place explains at its best heading of all."""
        return self.everywhere.heat()

    def _under(self, headings_rad: Sequence[float]) -> Localizer:
        all_round = self.everywhere
        localizer = Localizer.at_stop(
            all_round.the_map,
            all_round.map_id,
            headings_rad,
            self.within,
            judgement=all_round.judgement,
            threads=self.threads,
        )
        localizer.stop.add(all_round.stop.readings)
        return replace(localizer, layers=all_round.layers)


_axes: WeakKeyDictionary[ReadyMap, Axis | None] = WeakKeyDictionary()
"""Of the maps in use: found once a map, not once a stop."""


def _axis_of(the_map: ReadyMap) -> Axis | None:
    if the_map not in _axes:
        _axes[the_map] = map_axis(the_map.ternary.occupied, the_map.spec.resolution_m, _SETTINGS)
    return _axes[the_map]
