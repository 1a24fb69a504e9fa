"""From readings to a pose estimate: feasible poses counted, the best regions found, their uniqueness judged.

The consistent reading method of [BrownDonald2000]_ sec. 2.2.1: look for the poses that explain the most readings. It
bears bad readings and obstacles that are not on the map (fig. 6), and it does not hide that several places look alike.
"""

import math
from collections.abc import Sequence

from robotd.core.reading import RangeReading
from robotd.grid.readings import numbers_of
from robotd.localization.area import Area
from robotd.localization.counting import NOTHING, Count, Found
from robotd.localization.described import Situation, described
from robotd.localization.estimate import PoseEstimate, PoseState, Region
from robotd.localization.ready_map import ReadyMap
from robotd.localization.refinement import RefinementSettings
from robotd.localization.regions import pieces_of


class Localizer:
    """Localizes on one map, stop after stop; an estimate may be asked for after any reading."""

    def __init__(
        self, the_map: ReadyMap, map_id: str, *, refinement: RefinementSettings | None = None, threads: int = 1
    ) -> None:
        """Begin with no readings, heading 0.

        Args:
            the_map: the map, and what counts as an answer.
            map_id: what estimates call the map.
            refinement: how poses are refined.
            threads: how many threads may share the work when it is much; no estimate depends on it.
        """
        self._threads = threads
        self._map = the_map
        self._settings = the_map.settings
        self._refinement = refinement or RefinementSettings()
        self._map_id = map_id
        self.begin((0.0,))

    def begin(self, headings_rad: Sequence[float], within: Area | None = None) -> None:
        """Forget the readings of the last stop.

        Args:
            headings_rad: the robot's possible headings in the map frame, ascending; one if odometry knows it.
            within: where on the map it is, if that is known; then no other place is an answer.
        """
        self._count = Count(self._map, headings_rad, within, threads=self._threads)

    def add(self, *readings: RangeReading) -> None:
        """Count measured readings, hits or misses; many at once cost less than one after the other.

        Raises:
            ValueError: a reading measured nothing; then none is counted.
        """
        self._count.add(*readings)

    def estimate(self, time_ns: int, *, final: bool) -> PoseEstimate:
        """Return what the readings so far say.

        Args:
            time_ns: when the robot was there.
            final: whether the sweep is whole.
        """
        found = self._find()
        regions, left_out = self._regions(found)
        state = self._judge(regions, left_out, is_all=found.is_all)
        return PoseEstimate(
            time_ns=time_ns,
            state=state,
            best=regions[0].pose if state is PoseState.LOCALIZED else None,
            regions=regions,
            best_rank=found.best_rank,
            readings=len(self._count.readings),
            final=final,
            map_id=self._map_id,
            regions_left_out=left_out,
            bearings_rad=tuple(reading.bearing_rad for reading in self._count.readings),
        )

    def _find(self) -> Found:
        settings, readings = self._settings, len(self._count.readings)
        if readings < settings.readings_min:
            return NOTHING
        slack, least_rank = settings.rival_share * readings, settings.localized_share * readings
        return self._count.best(math.ceil(slack), math.ceil(least_rank))

    def _regions(self, found: Found) -> tuple[tuple[Region, ...], int]:
        """Return the regions that explain enough of the readings, and how many more there are."""
        headings_rad = self._count.headings_rad
        pieces = pieces_of(found.poses, found.ranks, headings_rad, self._settings.regions_max)
        situation = Situation(self._map, headings_rad, numbers_of(self._count.readings), self._refinement)
        return described(pieces.best, situation), pieces.left_out

    def _judge(self, regions: tuple[Region, ...], left_out: int, *, is_all: bool) -> PoseState:
        if not regions:
            return PoseState.LOST if is_all else PoseState.AMBIGUOUS
        spread_m = max(_farthest_m(region, regions[0]) for region in regions)
        is_one_place = is_all and left_out == 0 and spread_m <= self._settings.unique_within_m
        return PoseState.LOCALIZED if is_one_place else PoseState.AMBIGUOUS


def _farthest_m(region: Region, best: Region) -> float:
    """Return how far the box round a region reaches from the centre of the best one."""
    x_m, y_m = best.centre.x_m, best.centre.y_m
    extent = region.extent
    return math.hypot(
        max(extent.x_max_m - x_m, x_m - extent.x_min_m),
        max(extent.y_max_m - y_m, y_m - extent.y_min_m),
    )
