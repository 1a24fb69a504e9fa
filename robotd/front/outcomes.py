"""What became of the latest missions, for a client that missed the message."""

import asyncio
from collections import OrderedDict

from robotd.contract.events import Event, MissionProgress
from robotd.core.broadcast import Broadcast

_REMEMBERED = 16
"""Missions; a client asks for the end of its own within its lease, so the last few would do."""
_TURNS_TO_THE_END = 50


class Outcomes:
    """The latest progress of the latest missions."""

    def __init__(self) -> None:
        self._progress: OrderedDict[int, MissionProgress] = OrderedDict()

    async def follow(self, events: Broadcast[Event]) -> None:
        """Note progress as it is published, until cancelled."""
        with events.subscribe() as stream:
            async for event in stream:
                if isinstance(event, MissionProgress):
                    self._note(event)

    def latest(self, mission_id: int) -> MissionProgress | None:
        """Return how far a mission came, or None if it is unknown or forgotten."""
        return self._progress.get(mission_id)

    async def end_of(self, mission_id: int) -> MissionProgress | None:
        """Return how a mission ended, if it did and that is known; it may be about to be told."""
        # Between a mission's last step and the word of it lie a few turns of the loop.
        for _ in range(_TURNS_TO_THE_END):
            progress = self.latest(mission_id)
            if progress is not None and progress.is_last:
                return progress
            await asyncio.sleep(0)
        return None

    def _note(self, progress: MissionProgress) -> None:
        self._progress[progress.mission_id] = progress
        if len(self._progress) > _REMEMBERED:
            self._progress.popitem(last=False)
