"""Tells the world what becomes of the whereabouts: another map, a pose carried on, or that it is not known any more."""

import logging
from collections.abc import Callable

from robotd.core.clock import now_ns
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Odometry
from robotd.mission.news import Publish
from robotd.mission.whereabouts.map_in_use import MapInUse, in_place_of
from robotd.mission.whereabouts.tie import Tie
from robotd.mission.whereabouts.whereabouts import Whereabouts, unlocalized
from robotd.recording.results import map_result

log = logging.getLogger(__name__)


class WhereaboutsTold:
    """Changes the whereabouts, and says so at once: not to know where the robot is, is said and not left to silence."""

    def __init__(
        self,
        whereabouts: Whereabouts,
        publish: Publish,
        publish_status: Callable[[], None],
        let_go: Callable[[int], None],
        advise: Callable[[GridSpec], str | None],
    ) -> None:
        """Change ``whereabouts``; another map is told of in the status, too, and ``let_go`` of the one before.

        Where settings cannot work on its cells, the log says what to take instead, by ``advise``.
        """
        self._whereabouts = whereabouts
        self._publish = publish
        self._publish_status = publish_status
        self._let_go = let_go
        self._advise = advise

    def begin(self) -> None:
        """Say that nothing is known yet."""
        self._publish(unlocalized(now_ns(), ""))

    def adopt(self, place: MapInUse, tie: Tie | None) -> None:
        """Take another map into use."""
        before = self._whereabouts.map_in_use
        log.info("map %s (%s) is in use%s", place.name, place.map_id, in_place_of(before))
        if (advice := self._advise(place.spec)) is not None:
            log.warning("map %s: %s", place.name, advice)
        # Before the old map is let go: what is asked from here on names the new one.
        self._whereabouts.adopt(place, tie)
        # The same map may be adopted again, tied otherwise.
        if before is not None and before.number != place.number:
            self._let_go(before.number)
        whole = place.whole(now_ns())
        # The journal has the digest alone; the cells may be megabytes.
        self._publish(whole, map_result(whole, place.digest))
        if tie is None:
            self._publish(unlocalized(now_ns(), place.map_id))
        self._publish_status()

    def doubt(self) -> None:
        """Believe odometry no longer; without a map there is nothing to be lost on."""
        place = self._whereabouts.map_in_use
        if self._whereabouts.doubt() and place is not None:
            self._publish(unlocalized(now_ns(), place.map_id))

    def moved(self, odometry: Odometry, *, predicts: bool) -> None:
        """Pass odometry on, and the pose that it leads to, unless something else has the better word on that now."""
        # Odometry first: the pose is made of it, and a reader that draws both finds them in that order.
        self._publish(odometry)
        if predicts and (estimate := self._whereabouts.moved(odometry)) is not None:
            self._publish(estimate)
