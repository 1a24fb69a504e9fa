"""What is known of the robot by now: what a browser that joins is told at once, and what the gateway itself goes by."""

from collections import deque
from collections.abc import Iterator

from robotd.contract.events import MissionProgress, Status
from robotd.contract.plain import from_plain
from robotd.core.clock import NS_PER_S
from robotd.gateway.feed.heard_frames import HeardFrame
from robotd.gateway.feed.map_kept import MapKept

FIRST = ("status", "mission_progress")
"""What a page needs before everything else."""
LOG_LINES = 500
_NOT_KEPT = {"range_measured", "sweep_readings"}
"""Parts of something: alone they tell nothing."""


class Snapshot:
    """The last of everything, of one life of the daemon."""

    def __init__(self) -> None:
        self.session: str | None = None
        """Which life of the daemon; None before its first word."""
        self.status: Status | None = None
        self.mission: MissionProgress | None = None
        self.pose_state: str | None = None
        """The word of the last estimate; None before the first."""
        self.map = MapKept()
        self.map_gap = False
        """Whether a change of the map was missed: the whole has to be asked for."""
        self._status_ns: int | None = None
        self._last: dict[str, bytes] = {}
        self._log: deque[bytes] = deque(maxlen=LOG_LINES)

    def accept(self, heard: HeardFrame, now_ns: int) -> None:
        """Take a message.

        Raises:
            ValueError: it is not what its name promises.
            RemoteProtocolError: the same, of a map.
        """
        # Another life of the daemon, whose numbers begin again: nothing of the last one may stand beside it.
        if heard.session != self.session:
            self._begin(heard.session)
        if heard.topic == "map" and heard.event == "map_changed":
            self._take_map(heard)
            return
        if heard.topic == "log":
            self._log.append(heard.data)
            return
        if heard.event == "status":
            self.status, self._status_ns = from_plain(Status, heard.fields), now_ns
        elif heard.event == "mission_progress":
            self.mission = from_plain(MissionProgress, heard.fields)
        elif heard.event == "pose_estimate":
            self.pose_state = str(heard.fields["state"])
        if heard.event not in _NOT_KEPT:
            self._last[heard.event] = heard.data

    def silent_s(self, now_ns: int) -> float | None:
        """Return how long ago the last status came; None if none came yet."""
        return None if self._status_ns is None else (now_ns - self._status_ns) / NS_PER_S

    def frames(self) -> Iterator[bytes]:
        """Yield what makes somebody who joins know as much as who was here all the time."""
        yield from (self._last[name] for name in FIRST if name in self._last)
        yield from (frame for name, frame in self._last.items() if name not in FIRST)
        yield from self.map.frames
        yield from self._log

    def _begin(self, session: str) -> None:
        """Forget what another life of the daemon told: its map, its way and its plan are not this one's."""
        self.session, self.status, self.mission, self._status_ns = session, None, None, None
        self.pose_state = None
        self._last.clear()
        self._log.clear()
        self.map.forget()

    def _take_map(self, heard: HeardFrame) -> None:
        if heard.fields["map_id"] is None:
            self.map.forget()
            self._last["map_changed"] = heard.data
            return
        # It was the word that there is no map.
        self._last.pop("map_changed", None)
        self.map_gap = not self.map.accept(heard)
