"""Plays a recording to the daemon, in its process and on the virtual clock.

The loop is led through the entries in file order, and each takes effect at its recorded time: bytes arrive,
lines come and go, clients ask, array work is handed back. What the daemon writes goes nowhere; its journal
sees it, and :func:`robotd.recording.comparison.compare` judges it. The loop must start at the recording's first
moment, so that the daemon's times are the recorded ones::

    async def replay() -> None:
        playback = Playback(recording, carry_out)
        links = {name: playback.line(name).connect for name in devices}   # a Connect each
        ... start the daemon on these links and on playback.compute ...
        await playback.run()

    run_recorded(replay(), start_ns=recording.header.started_ns)
"""

import asyncio
from collections import Counter, defaultdict, deque
from collections.abc import Callable
from typing import TypeVar

from robotd.core.errors import TransportError
from robotd.hardware.link.tap import Direction
from robotd.recording.entries import (
    LINE_BROKE,
    BytesEntry,
    CauseEntry,
    CommandEntry,
    ComputedEntry,
    Entry,
    LineEntry,
    TurnEntry,
    is_input,
)
from robotd.recording.moments import RecordedTimeLoop, pass_to
from robotd.recording.reader import Recording

SETTLE_S = 0.001
"""How long after the last entry its effects are waited for."""

_ADDED_JOBS = {"begin map"}
"""Jobs that were no jobs when the first recordings were made: there they take no time."""

T = TypeVar("T")


class Playback:
    """The outside world of a recording: lines, clients, and the time that computing took."""

    def __init__(
        self,
        recording: Recording,
        carry_out: Callable[[CommandEntry], None],
        take_up: Callable[[CauseEntry], None] = lambda _: None,
    ) -> None:
        """Prepare to play.

        Args:
            recording: what to play.
            carry_out: called with each command at its time; must not block (start a task for what takes long).
            take_up: called with each cause at its place; must not block.
        """
        self._entries = recording.entries
        self._at = 0
        self._over = asyncio.Event()
        self._carry_out = carry_out
        self._take_up = take_up
        self._lines = {device: ReplayLine(device) for device in recording.devices}
        self.compute = RecordedCompute(recording)

    def line(self, device: str) -> "ReplayLine":
        """Return the line of a device; one that was never recorded never comes up."""
        return self._lines.setdefault(device, ReplayLine(device))

    async def run(self) -> None:
        """Let every entry take effect at its time, and end when the last has.

        Raises:
            TypeError: the loop is not one of :func:`robotd.recording.moments.run_recorded`.
        """
        loop = asyncio.get_running_loop()
        if not isinstance(loop, RecordedTimeLoop):
            raise TypeError("a recording is played on a RecordedTimeLoop: use run_recorded")
        loop.follow(self._next_ns, self._play_next)
        if self._entries:
            await self._over.wait()
        await asyncio.sleep(SETTLE_S)
        self.compute.release_all()

    def _next_ns(self) -> int | None:
        return self._entries[self._at].time_ns if self._at < len(self._entries) else None

    def _play_next(self) -> None:
        entry = self._entries[self._at]
        self._at += 1
        self._play(entry)
        if self._at == len(self._entries):
            self._over.set()
        elif is_input(entry):
            self._join()

    def _join(self) -> None:
        """Let the next input come in its turn if it came before the effects of this one were over."""
        for at in range(self._at, len(self._entries) - 1):
            entry = self._entries[at]
            if isinstance(entry, TurnEntry):
                self._play_after(entry.turns, at + 1)
            if isinstance(entry, TurnEntry) or is_input(entry):
                return

    def _play_after(self, turns: int, last: int) -> None:
        """Play up to an entry, this many turns of the loop from now."""
        if turns > 0:
            # Turn by turn, as the living loop did: what runs in each of them may ask for things of its own.
            asyncio.get_running_loop().call_soon(self._play_after, turns - 1, last)
            return
        while self._at <= last:
            self._play_next()

    def _play(self, entry: Entry) -> None:
        match entry:
            case BytesEntry(direction=Direction.FROM_BOARD):
                self.line(entry.device).deliver(entry)
            case LineEntry():
                self.line(entry.device).change(entry)
            case CommandEntry():
                self._carry_out(entry)
            case CauseEntry(name=name) if name == LINE_BROKE:
                self.line(entry.arguments["device"]).break_down(entry.arguments["reason"])
            case CauseEntry():
                asyncio.get_running_loop().call_soon(self._take_up_now, entry)  # bytes need a turn to be read, too
            case ComputedEntry():
                self.compute.release(entry)
            case _:
                """What the daemon wrote, and the results that it came to, are for the comparison."""

    def _take_up_now(self, entry: CauseEntry) -> None:
        pass_to(entry.time_ns)
        self._take_up(entry)


class ReplayLine:
    """One device's line through all its ups and downs."""

    def __init__(self, device: str) -> None:
        self._device = device
        self._current: ReplayTransport | None = None
        self._waiting: asyncio.Future[ReplayTransport] | None = None

    async def connect(self) -> "ReplayTransport":
        """Return the line as soon as the recording says that it was opened.

        An attempt that failed in the recording waits here instead: what the daemon does while there is no line
        leaves no trace in a recording.
        """
        if self._current is not None and not self._current.taken:
            self._current.taken = True
            return self._current
        self._waiting = asyncio.get_running_loop().create_future()
        transport = await self._waiting
        pass_to(transport.opened_ns)
        return transport

    def deliver(self, entry: BytesEntry) -> None:
        """Let bytes arrive from the board; on a line that is down they are lost."""
        if self._current is not None and entry.data:
            self._current.deliver(entry)

    def break_down(self, reason: str) -> None:
        """Let the next read fail as it did."""
        if self._current is not None:
            self._current.lose(reason)

    def change(self, entry: LineEntry) -> None:
        """Open the line, or lose it: the latter a turn later, for the daemon may give it up itself by then."""
        if self._current is not None:
            reason = f"{self._current.name}: the line was lost in the recording"
            asyncio.get_running_loop().call_soon(self._current.lose, reason)
        self._current = ReplayTransport(f"replay of {self._device}", entry.time_ns) if entry.up else None
        if self._current is not None and self._waiting is not None and not self._waiting.done():
            self._current.taken = True
            self._waiting.set_result(self._current)


class ReplayTransport:
    """A :class:`robotd.hardware.transport.transport.Transport` whose other end is a recording.

    Chunks arrive exactly as they were read when they were recorded.
    """

    def __init__(self, name: str, opened_ns: int) -> None:
        self._name = name
        self.opened_ns = opened_ns
        self._chunks: deque[BytesEntry] = deque()
        self._changed = asyncio.Event()
        self._lost: str | None = None
        self.taken = False
        """Whether somebody connected to it."""

    @property
    def name(self) -> str:
        """Whose line it was."""
        return self._name

    async def read(self) -> bytes:
        """Return the next recorded chunk; TransportError once the line is gone."""
        while not self._chunks:
            self._check()
            self._changed.clear()
            await self._changed.wait()
        entry = self._chunks.popleft()
        pass_to(entry.time_ns)
        return entry.data

    def write(self, data: bytes) -> None:
        """Take bytes for a board that is only played; TransportError if the line is gone."""
        self._check()

    def write_urgent(self, data: bytes) -> None:
        """Take bytes for a board that is only played; TransportError if the line is gone."""
        self._check()

    def write_past_loop(self, data: bytes) -> None:
        """Do nothing: a recording has no loop that could be stuck."""

    def close(self) -> None:
        """Give the line up."""
        # One who still reads must find the end, not what is left: in the recording nobody read it.
        self._chunks.clear()
        self.lose(f"{self._name}: closed")

    def deliver(self, entry: BytesEntry) -> None:
        """Let a chunk arrive."""
        if self._lost is None:
            self._chunks.append(entry)
            self._changed.set()

    def lose(self, reason: str) -> None:
        """Let the line go, and say why; what has arrived may still be read."""
        self._lost = self._lost or reason
        self._changed.set()

    def _check(self) -> None:
        if self._lost is not None:
            raise TransportError(self._lost)


class RecordedCompute:
    """Computes at once, and hands each result back when the recording did: a ``Compute`` of the mission's kind.

    A job that the recording does not see done is handed back after its end.
    """

    def __init__(self, recording: Recording) -> None:
        jobs = {(e.name, e.index): e.time_ns for e in recording.entries if isinstance(e, ComputedEntry)}
        self._times_ns = jobs
        self._is_first_format = not recording.notes_causes
        self._released = {job: asyncio.Event() for job in jobs}
        self._ended = asyncio.Event()
        self._done: Counter[str] = Counter()
        self._turns: defaultdict[str, asyncio.Lock] = defaultdict(asyncio.Lock)

    async def run(self, name: str, function: Callable[..., T], *args: object) -> T:
        """Return or raise what ``function(*args)`` does, no earlier than in the recording.

        Jobs of one name keep their order.
        """
        try:
            # On the loop itself: no robot waits for a replay, and when it is handed back is for the recording to say.
            result = function(*args)
        except Exception:
            # The first recordings did not note that a job failed: to wait would be to wait for their end.
            if not self._is_first_format:
                await self._wait(name)
            raise
        await self._wait(name)
        return result

    async def _wait(self, name: str) -> None:
        # In that recording it was done where it stood, so its end is noted nowhere.
        if self._is_first_format and name in _ADDED_JOBS:
            return
        # Jobs of one name wait for each other: which of them is the third must not depend on which was computed
        # first.
        async with self._turns[name]:
            job = name, self._done[name]
            await self._released.get(job, self._ended).wait()
            pass_to(self._times_ns.get(job, 0))
            self._done[name] += 1

    def release(self, entry: ComputedEntry) -> None:
        """Let a job be handed back."""
        self._released[entry.name, entry.index].set()

    def release_all(self) -> None:
        """Let every job be handed back: the recording has ended."""
        for event in (*self._released.values(), self._ended):
            event.set()
