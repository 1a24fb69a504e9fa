"""From readings to a pose estimate: count, judge, connect, refine, describe.

The consistent reading method of [BrownDonald2000]_ sec. 2.2.1: look for the poses that explain the most readings. It
bears bad readings and obstacles that are not on the map (fig. 6), and it does not hide that several places look alike.
Which of these it is, and whether that is sure, is for the second look (:mod:`.second_look`) to say.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.contract.area import Area
from robotd.contract.estimate import LayerSaid, PoseEstimate, PoseState
from robotd.core.reading import RangeReading, Slant, Tilt
from robotd.grid.pose_set import PoseSet
from robotd.grid.readings import Readings
from robotd.localization.claim import state_by_belief, state_by_proof
from robotd.localization.count.heat import Heat, block_of, counted_apart, pictured
from robotd.localization.describe import Situation, described
from robotd.localization.judge.judgement import Judgement
from robotd.localization.judge.likeliest import likeliest_look
from robotd.localization.judge.second_look import SecondLook
from robotd.localization.judged_regions import JudgedRegion, judged_regions
from robotd.localization.layer_seen import LayerSeen
from robotd.localization.ready_map import ReadyMap
from robotd.localization.stop import Stop


@dataclass(frozen=True, slots=True, eq=False)
class Localizer:
    """Localizes at one stop on one map: an :class:`~robotd.localization.estimator.Estimator`."""

    the_map: ReadyMap
    stop: Stop
    map_id: str
    """What estimates call the map."""
    judgement: Judgement
    layers: tuple[LayerSeen, ...] = ()
    """Further ones, which narrow down what the first one leaves."""

    @classmethod
    def at_stop(
        cls,
        the_map: ReadyMap,
        map_id: str,
        headings_rad: Sequence[float],
        within: Area | None = None,
        *,
        judgement: Judgement | None = None,
        layers: Sequence[tuple[Tilt, ReadyMap]] = (),
        threads: int = 1,
    ) -> "Localizer":
        """Begin with no readings.

        Args:
            the_map: the map, and what counts as explained.
            map_id: what estimates call the map.
            headings_rad: the robot's possible headings in the map frame, ascending; one if odometry knows it.
            within: where on the map it is, if that is known; then no other place is an answer.
            judgement: what counts as an answer.
            layers: further layers of the map, which have a word in it once something was seen at their tilts.
            threads: how many threads may share the work when it is much; no estimate depends on it.
        """
        stop = the_map.stop(headings_rad, within, threads=threads)
        seen = tuple(LayerSeen(tilt, ready) for tilt, ready in layers)
        return cls(the_map, stop, map_id, judgement or Judgement(), seen)

    def add(self, *readings: RangeReading) -> None:
        """Count measured readings, hits or misses; many at once cost less than one after the other.

        Raises:
            ValueError: a reading measured nothing; then none is counted.
        """
        self.stop.add(Readings.of(readings))

    def add_slants(self, *slants: Slant) -> None:
        """Take what was seen at further tilts; of a tilt that the map has no layer of, nothing is known."""
        for slant in slants:
            for layer in self.layers:
                if layer.tilt.tilt_rad == slant.tilt.tilt_rad:
                    layer.add(Readings.of(tuple(reading for reading in slant.readings if reading.is_measured)))

    def estimate(self, time_ns: int, *, final: bool) -> PoseEstimate:
        """Return what the readings so far say.

        Args:
            time_ns: when the robot was there.
            final: whether the sweep is whole.
        """
        readings, least = self.stop.readings, self.the_map.settings.readings_min
        # A handful of readings is explained nearly anywhere: saying nothing is better than naming half of the map.
        found = self.stop.best_poses() if len(readings) >= least else PoseSet.nothing()
        seen = [layer for layer in self.layers if len(layer.readings)]
        found, said = self._agreed(found, seen)
        poses_m = found.in_metres(self.the_map.spec, self.stop.headings_rad)
        meanings = self.the_map.meanings
        likelihoods = [meaning.likelihood for meaning in meanings]
        look_by, views = self.judgement.second_look, [layer.view for layer in seen]
        meant, look = likeliest_look(likelihoods, readings, poses_m, found.ranks, look_by, *views)
        state = self._claimed(found, look)
        # After the judgement: connecting is dear where poses are many, and a robot that is lost has no region
        # to tell.
        connected, left_out = self._connected(found, poses_m, look, state)
        situation = Situation(
            self.the_map, meanings[meant].walls, self.stop.headings_rad, readings, self.judgement.refinement
        )
        regions = described(connected, situation)
        return PoseEstimate(
            time_ns=time_ns,
            state=state,
            # Of several regions all are the answer (sec. 2.2.1); a best one would be taken for the answer itself.
            best=regions[0].pose if state is PoseState.LOCALIZED else None,
            regions=regions,
            best_rank=found.best_rank,
            readings=len(readings),
            final=final,
            map_id=self.map_id,
            regions_left_out=left_out,
            complete=found.is_all,
            belief_aside=look.aside,
            belief_nowhere=look.nowhere,
            # Infinite where the place has no rival: None says that in a message.
            contrast=look.contrast if math.isfinite(look.contrast) and len(look.poses) else None,
            ends=look.ends,
            # In the order of each region's `explained`, so that a reader knows which reading that was.
            bearings_rad=tuple(readings.bearing_rad.tolist()),
            layers=said,
        )

    def heat(self) -> Heat:
        """Return how many of the readings so far each place explains at its best heading, anywhere on the map."""
        ranks, levels, headings_rad = self.stop.counted, self.the_map.prepared, self.stop.headings_rad
        if ranks is None:
            return counted_apart(levels, self.stop.readings, headings_rad)
        return pictured(levels.spec, ranks.heat(block_of(levels.spec)), ranks.readings, len(headings_rad))

    def _agreed(self, found: PoseSet, seen: Sequence[LayerSeen]) -> tuple[PoseSet, tuple[LayerSaid, ...]]:
        """Return the poses that no layer speaks against, and what each says of the rest."""
        said = []
        for layer in seen:
            found, best_rank = layer.agreeing(found, self.stop.headings_rad)
            said.append(LayerSaid(layer.tilt.tilt_rad, len(layer.readings), best_rank))
        return found, tuple(said)

    def _claimed(self, found: PoseSet, look: SecondLook) -> PoseState:
        if self.the_map.settings.conservative:
            return state_by_proof(found, self.stop.headings_rad, self.the_map.spec.resolution_m)
        return state_by_belief(found, look.state)

    def _connected(
        self, found: PoseSet, poses_m: NDArray[np.float64], look: SecondLook, state: PoseState
    ) -> tuple[tuple[JudgedRegion, ...], int]:
        """Return the answers that remain, and how many more there are."""
        if state is PoseState.LOST or len(found) == 0:
            return (), 0
        most = self.the_map.settings.regions_max
        regions, left_out = judged_regions(found, poses_m, look, self.stop.headings_rad, most)
        # Once it is sure, the other regions are not left out but ruled out.
        return (regions[:1], 0) if state is PoseState.LOCALIZED else (regions, left_out)
