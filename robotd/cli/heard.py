"""What a recorded robot told, computed again as by a replay, for other programs."""

from dataclasses import dataclass, field
from pathlib import Path

from robotd.contract.events import Event
from robotd.core.clock import NS_PER_S


@dataclass(slots=True)
class HeardRecording:
    """What of a recording is exported: events in the order in which clients heard them."""

    events: list[Event] = field(default_factory=list)
    wall_offset_ns: int = 0

    @classmethod
    def of(cls, file: Path, *kinds: type) -> "HeardRecording":
        """Return the events of these kinds that a recording comes to.

        Raises:
            RecordingError: it cannot be replayed.
        """
        from robotd.app.replaying import replay_events  # noqa: PLC0415  # only here is a daemon needed inside

        heard = cls()
        header = replay_events(file, lambda event: heard.events.append(event) if isinstance(event, kinds) else None)
        heard.wall_offset_ns = header.wall_offset_ns
        return heard

    def unix_s(self, time_ns: int) -> float:
        """Return a monotonic time as Unix time."""
        return (time_ns + self.wall_offset_ns) / NS_PER_S
