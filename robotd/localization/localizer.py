"""From readings to a pose estimate: feasible poses counted, connected, looked at once more, and refined.

The consistent reading method of [BrownDonald2000]_ sec. 2.2.1: look for the poses that explain the most readings. It
bears bad readings and obstacles that are not on the map (fig. 6), and it does not hide that several places look alike.
Which of these it is, and whether that is sure, is for the second look (:mod:`.second_look`) to say.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robotd.contract.area import Area
from robotd.contract.estimate import PoseEstimate, PoseState, Region
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading
from robotd.grid.pose_set import PoseSet
from robotd.grid.readings import numbers_of
from robotd.localization.conservative.unexcluded import Unexcluded
from robotd.localization.describe import JudgedRegion, Situation, described
from robotd.localization.judge.judgement import Judgement
from robotd.localization.judge.second_look import SecondLook, second_look
from robotd.localization.places.pieces import pieces_of
from robotd.localization.ready_map import ReadyMap
from robotd.localization.stop import Count

_ALIKE_M, _ALIKE_RAD = 0.1, 0.03
"""So much aside and so much turned are as far from a place."""
_UNIQUE_M = 1.0
"""In the conservative mode, a region that is longer is no one place."""


class Localizer:
    """Localizes on one map, stop after stop; an estimate may be asked for after any reading."""

    def __init__(self, the_map: ReadyMap, map_id: str, judgement: Judgement | None = None, *, threads: int = 1) -> None:
        """Begin with no readings, heading 0.

        Args:
            the_map: the map, and what counts as explained.
            map_id: what estimates call the map.
            judgement: what counts as an answer.
            threads: how many threads may share the work when it is much; no estimate depends on it.
        """
        self._threads = threads
        self._map = the_map
        self._settings = the_map.settings
        self._judgement = judgement or Judgement()
        self._map_id = map_id
        self.begin((0.0,))

    def begin(self, headings_rad: Sequence[float], within: Area | None = None) -> None:
        """Forget the readings of the last stop.

        Args:
            headings_rad: the robot's possible headings in the map frame, ascending; one if odometry knows it.
            within: where on the map it is, if that is known; then no other place is an answer.
        """
        sure, share, threads = self._map.sure, self._settings.outlier_share, self._threads
        self._count: Count | Unexcluded
        if sure is None:
            self._count = Count(self._map, headings_rad, within, threads=threads)
        else:
            self._count = Unexcluded(sure, headings_rad, within, outlier_share=share, threads=threads)

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
        enough, numbers = len(self._count.readings) >= self._settings.readings_min, numbers_of(self._count.readings)
        found = self._count.answers() if enough else PoseSet.nothing()
        poses = self._in_metres(found.poses)
        look = second_look(self._map.likelihood, numbers, poses, found.ranks, self._judgement.second_look)
        state = self._state(found, look)
        regions, left_out = self._regions(found, poses, look, state, numbers)
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
            belief_aside=look.aside,
            belief_nowhere=look.nowhere,
            contrast=look.contrast if math.isfinite(look.contrast) and len(look.poses) else None,
            bearings_rad=tuple(reading.bearing_rad for reading in self._count.readings),
        )

    def _state(self, found: PoseSet, look: SecondLook) -> PoseState:
        """Return what may be claimed; in the conservative mode belief excludes nothing, only proof does."""
        if not found.is_all:
            return PoseState.AMBIGUOUS
        if self._map.sure is None:
            return look.state
        if len(found.poses) == 0:
            return PoseState.LOST
        is_one = self._is_one_place(found)
        return PoseState.LOCALIZED if is_one else PoseState.AMBIGUOUS

    def _is_one_place(self, found: PoseSet) -> bool:
        """Whether poses are all connected, and no corridor or room full of them."""
        pieces = pieces_of(found, self._count.headings_rad, 1)
        cells = _UNIQUE_M / self._map.ternary.spec.resolution_m
        return pieces.left_out == 0 and float(np.hypot(*np.ptp(found.poses[:, 1:], axis=0))) <= cells

    def _in_metres(self, poses: NDArray[np.intp]) -> NDArray[np.float64]:
        """Return poses ``(heading, row, col)`` as x, y [m] and heading [rad]."""
        spec = self._map.ternary.spec
        cells = poses[:, 1:] + 0.5
        x_m, y_m = spec.origin_x_m + cells[:, 1] * spec.resolution_m, spec.origin_y_m + cells[:, 0] * spec.resolution_m
        return np.stack((x_m, y_m, np.array(self._count.headings_rad)[poses[:, 0]]), axis=1)

    def _regions(
        self,
        found: PoseSet,
        poses: NDArray[np.float64],
        look: SecondLook,
        state: PoseState,
        numbers: NDArray[np.float64],
    ) -> tuple[tuple[Region, ...], int]:
        """Return the answers that remain, and how many more there are."""
        if state is PoseState.LOST or len(poses) == 0:
            return (), 0
        settings, headings_rad = self._settings, self._count.headings_rad
        nearest = np.array([_nearest(poses, place) for place in look.poses], np.intp)
        pieces = pieces_of(found, headings_rad, settings.regions_max, nearest)
        answers = [JudgedRegion(piece) for piece in pieces.best]
        for place, number, belief in zip(look.poses, nearest, look.beliefs, strict=True):
            _give(answers, found.poses[number], Pose2(*place.tolist()), float(belief))
        if state is PoseState.LOCALIZED:
            answers = answers[:1]
        situation = Situation(self._map, headings_rad, numbers, self._judgement.refinement)
        return described(answers, situation), 0 if state is PoseState.LOCALIZED else pieces.left_out


def _nearest(poses: NDArray[np.float64], place: NDArray[np.float64]) -> int:
    """Return which of the poses a place is nearest to."""
    off = poses - place
    turned_rad = (off[:, 2] + math.pi) % math.tau - math.pi
    return int(np.hypot(np.hypot(off[:, 0], off[:, 1]) / _ALIKE_M, turned_rad / _ALIKE_RAD).argmin())


def _give(answers: list[JudgedRegion], pose: NDArray[np.intp], place: Pose2, belief: float) -> None:
    """Give the region that holds a pose the belief in the place it is nearest to; the first to come is the best."""
    for number, answer in enumerate(answers):
        if answer.piece.holds(pose):
            answers[number] = JudgedRegion(answer.piece, answer.belief + belief, answer.begin or place)
            return
