"""Pictures of what each place explains, for who looks on: missions wait for none of it, and nothing follows from it.

A replay has nobody who looks on, so what is made here must not be waited for, noted, or learned from.
"""

import logging
from typing import NoReturn

from robotd.contract.events import RankMap
from robotd.core.broadcast import Subscription
from robotd.core.clock import now_ns
from robotd.core.log_limit import LogLimit
from robotd.head.head import Head
from robotd.head.jobs import Ranks, ShowRanks
from robotd.mission.news import Publish
from robotd.mission.whereabouts.map_in_use import MapInUse

log = logging.getLogger(__name__)


class RanksTold:
    """Has the head make pictures of the stop under way, as long as somebody wants them."""

    def __init__(self, head: Head, publish: Publish) -> None:
        """Prepare; nothing is made before :meth:`run`."""
        self.are_wanted = False
        self._head = head
        self._publish = publish
        self._complaints = LogLimit()
        # Room for one: a viewer wants the newest picture, and a queue of old ones would keep the head from the
        # mission.
        self._wishes: Subscription[tuple[ShowRanks, str, int, int]] = Subscription(1)
        """The latest; one that was not begun yet is of no use any more."""

    def show(self, stop: int, place: MapInUse, generation: int, number: int) -> None:
        """Have the stop pictured as it is when its turn comes: on this map after that change, by sweep ``number``."""
        if self.are_wanted:
            self._wishes.offer((ShowRanks(stop), place.map_id, generation, number))

    async def run(self) -> NoReturn:
        """Make pictures until cancelled."""
        while True:
            # Map and generation are those of the wish: by the time a picture is made, another map may be in
            # use.
            job, map_id, generation, number = await self._wishes.get()
            try:
                shown = await self._head.ask(job)
            except Exception as error:  # whatever it is: a picture must not stop a robot
                if line := self._complaints.line(f"no picture of a stop was made: {error!r}"):
                    log.error("%s", line)  # noqa: TRY400  # where it went wrong is the head's to say
                continue
            if shown.ranks is not None:
                self._publish(_rank_map(shown.ranks, map_id, generation, number))


def _rank_map(ranks: Ranks, map_id: str, generation: int, number: int) -> RankMap:
    spec = ranks.spec
    return RankMap(
        time_ns=now_ns(),
        map_id=map_id,
        generation=generation,
        number=number,
        readings=ranks.readings,
        headings=ranks.headings,
        reduce=ranks.block,
        resolution_m=spec.resolution_m,
        origin_x_m=spec.origin_x_m,
        origin_y_m=spec.origin_y_m,
        rows=spec.rows,
        cols=spec.cols,
        levels_zlib=ranks.levels_zlib,
    )
