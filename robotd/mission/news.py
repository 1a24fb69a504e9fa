"""What happens is told here, in one order: the journal has it first, then the world.

Nothing is learned or decided on the way: what follows from an event is done by the one that makes it, before it is
told.
"""

from collections.abc import Callable
from typing import Protocol

from robotd.contract.events import Event
from robotd.core.broadcast import Broadcast
from robotd.recording.entries import ResultEntry
from robotd.recording.results import result_of


class Publish(Protocol):
    """Hands an event to the world, and to the journal; ``made`` is its entry there if that was made already."""

    def __call__(self, event: Event, made: ResultEntry | None = None) -> None:
        """Return at once."""


class News:
    """Tells the journal and the world."""

    def __init__(self, note: Callable[[ResultEntry], None]) -> None:
        """Tell; ``note`` takes what a replay must come to again."""
        self.events: Broadcast[Event] = Broadcast()
        self._note = note

    def publish(self, event: Event, made: ResultEntry | None = None) -> None:
        """Hand an event to the journal, if it is a result, and to the world.

        ``made`` is its entry in the journal, if it was made already: where encoding takes long, or where the journal is
        to have less than the world.
        """
        entry = result_of(event) if made is None else made
        # The journal before the world: a client that acts on an event must find it noted before what it asks
        # for.
        if entry is not None:
            self._note(entry)
        self.events.publish(event)
