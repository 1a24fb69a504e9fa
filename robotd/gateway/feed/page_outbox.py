"""What waits to be sent to one browser. Nothing in it grows with how slow the browser is.

Of most events only the newest waits; lines of the log and readings are counted where they are left out, and told of;
changes of the map stay in order, and become one whole map where there are too many of them.
"""

from collections import OrderedDict, deque
from collections.abc import Callable

from robotd.gateway.feed.heard_frames import HeardFrame

MOST_LINES = 500
"""Lines of the log, and other messages of which each counts, that wait at most, of each topic."""
MOST_CHANGES = 64
MOST_CHANGE_BYTES = 1 << 20
MOST_BYTES = 8 << 20
MOST_TEXTS = 256

_NEWEST = {
    *("status", "mission_progress", "pose_estimate", "odometry", "rank_map", "plan"),
    *("sweep_begun", "sweep_progress", "sweep_done"),
}
_FIRST = ("status", "mission_progress")

_Key = str | int


class Full(Exception):  # a signal to who serves the browser, which ends
    """More waits than there is room for: the browser reads nothing."""


class PageOutbox:
    """The frames and texts of one browser, in the order in which they are sent."""

    def __init__(self, whole_map: Callable[[], list[bytes]]) -> None:
        """Ask ``whole_map`` for the map where its changes would be too many."""
        self._whole_map = whole_map
        self._texts: deque[str] = deque()
        self._question: str | None = None
        self._frames: OrderedDict[_Key, bytes] = OrderedDict()
        self._lines: dict[str, deque[int]] = {}
        self._changes: deque[int] = deque()
        self._wants_whole_map = False
        self._lost: dict[str, int] = {}
        self._number = 0
        self._bytes = 0
        self.dropped = 0
        """Messages that were left out, of whatever kind."""

    def __bool__(self) -> bool:
        """Whether anything waits."""
        return bool(self._texts or self._question or self._frames or self._lost or self._wants_whole_map)

    def ask(self, text: str) -> None:
        """Put a question in the place of an older one: before everything else, as silence is measured by it."""
        self._question = text

    def say(self, text: str) -> None:
        """Let a text wait; an answer is never left out.

        Raises:
            Full: too many wait.
        """
        if len(self._texts) >= MOST_TEXTS:
            raise Full
        self._texts.append(text)

    def put(self, heard: HeardFrame) -> None:
        """Let a message wait.

        Raises:
            Full: too much waits.
        """
        if heard.event in _NEWEST:
            self._put_newest(heard)
        elif heard.event == "map_changed":
            self._put_change(heard)
        else:
            self._put_line(heard)
        if self._bytes > MOST_BYTES:
            raise Full

    def greet(self, frames: list[bytes]) -> None:
        """Let what a browser that joins has to know wait, in this order."""
        for frame in frames:
            self._keep(self._next(), frame)

    def note_lost(self, topic: str, count: int) -> None:
        """Tell that messages of a topic were left out."""
        self._lost[topic] = self._lost.get(topic, 0) + count
        self.dropped += count

    def take(self) -> str | bytes | dict[str, int] | None:
        """Return what goes next: a text, a frame, or what was lost, by topic; None if nothing waits."""
        if self._question is not None:
            question, self._question = self._question, None
            return question
        if self._texts:
            return self._texts.popleft()
        for name in _FIRST:
            if name in self._frames:
                return self._drop(name)
        if self._lost:
            lost, self._lost = self._lost, {}
            return lost
        if self._wants_whole_map:
            self._wants_whole_map = False
            # Before all else that waits: what happens on the map makes no sense to a page without it.
            self._frames = OrderedDict([*((self._next(), frame) for frame in self._whole_map()), *self._frames.items()])
            self._bytes = sum(map(len, self._frames.values()))
        return self._drop(next(iter(self._frames))) if self._frames else None

    def _put_newest(self, heard: HeardFrame) -> None:
        before = self._frames.get(heard.event)
        if before is not None:
            self._bytes -= len(before)
            self.dropped += 1
        self._keep(heard.event, heard.data)

    def _put_line(self, heard: HeardFrame) -> None:
        lines = self._lines.setdefault(heard.topic, deque())
        # Sent since: taken out here and not where it is sent, which would search a queue for each frame.
        while lines and lines[0] not in self._frames:
            lines.popleft()
        if len(lines) >= MOST_LINES:
            self._drop(lines.popleft())
            self.note_lost(heard.topic, 1)
        lines.append(self._next())
        self._keep(lines[-1], heard.data)

    def _put_change(self, heard: HeardFrame) -> None:
        if self._wants_whole_map:
            return  # it will have this change, too
        while self._changes and self._changes[0] not in self._frames:
            self._changes.popleft()
        waiting = sum(len(self._frames[key]) for key in self._changes if key in self._frames)
        # A whole map, or the word that there is none, makes all that waited before it needless.
        if heard.fields["whole"] or heard.fields["map_id"] is None:
            self._forget_changes()
        elif len(self._changes) >= MOST_CHANGES or waiting + len(heard.data) > MOST_CHANGE_BYTES:
            self._forget_changes()
            self._wants_whole_map = True
            return
        self._changes.append(self._next())
        self._keep(self._changes[-1], heard.data)

    def _forget_changes(self) -> None:
        for key in self._changes:
            if key in self._frames:
                self._drop(key)
                self.dropped += 1
        self._changes.clear()

    def _keep(self, key: _Key, frame: bytes) -> None:
        self._frames[key] = frame
        self._bytes += len(frame)

    def _drop(self, key: _Key) -> bytes:
        frame = self._frames.pop(key)
        self._bytes -= len(frame)
        return frame

    def _next(self) -> int:
        self._number += 1
        return self._number
