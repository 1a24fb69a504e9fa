"""What became of the latest missions, for a client that missed the message."""

from collections import OrderedDict

from robotd.contract.events import Event, MissionProgress
from robotd.core.broadcast import Broadcast

_REMEMBERED = 16
"""Missions; a client asks for the end of its own within its lease, so the last few would do."""


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

    def _note(self, progress: MissionProgress) -> None:
        self._progress[progress.mission_id] = progress
        if len(self._progress) > _REMEMBERED:
            self._progress.popitem(last=False)
