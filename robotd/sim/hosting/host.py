"""Lets one emulated board live on the loop's clock, with a line to the daemon or without."""

import asyncio
import contextlib
from collections.abc import Callable, Coroutine
from typing import Any, Protocol, TypeVar, runtime_checkable

from firmware_proto.common import BoardState, Fault
from robotd.core.errors import TransportError
from robotd.hardware.transport.transport import Transport
from robotd.sim.hosting.board_clock import BoardClock
from robotd.sim.hosting.pace import HostTime, Time

T = TypeVar("T")

_NS_PER_US = 1000


class HostedBoard(Protocol):
    """A board without a line, whether it works or only plays a part: bytes in, bytes out, at the board's own time."""

    @property
    def next_event_us(self) -> int | None:
        """When :meth:`advance` must be called at the latest; None while nothing is to come."""

    def receive(self, data: bytes, now_us: int) -> None:
        """Take bytes from the host."""

    def advance(self, now_us: int) -> None:
        """Let time pass."""

    def take_output(self) -> bytes:
        """Return, once, the bytes that the board has for the host."""


@runtime_checkable
class OwnBoard(HostedBoard, Protocol):
    """One of our own boards, whatever its firmware is written in."""

    @property
    def state(self) -> BoardState:
        """Where in its life the board is; ``FAULT`` lies over the state beneath it."""

    @property
    def faults(self) -> Fault:
        """The latched faults."""

    def reboot(self, boot_id: int) -> None:
        """Lose power and come back: motors cut, everything forgotten, bytes under way lost."""


async def serve(
    board: HostedBoard,
    clock: BoardClock,
    lines: "asyncio.Queue[Transport]",
    *,
    on_step: Callable[[], None] = lambda: None,
    time: Time | None = None,
) -> None:
    """Run a board until cancelled, on one line after the other as they come; in between it is unplugged.

    The board wakes when bytes arrive and when something falls due (deadman, telemetry, an answer). What it
    says while nobody listens is lost, as on a real line.

    Args:
        board: the board, which is nobody else's.
        clock: the board's own clock.
        lines: where new lines come from; a line is closed here once its other end is gone.
        on_step: called after the board did something.
        time: what it lives by; the host's unless another is given.
    """
    life = _Life(board, clock, on_step, time or HostTime())
    while True:
        life.line = None
        line = await life.meanwhile(lines.get())
        life.line = line
        try:
            with contextlib.suppress(TransportError):
                while True:
                    life.hear(await life.meanwhile(line.read()))
        finally:
            line.close()


class _Life:
    """A board, its clock and its present line."""

    def __init__(self, board: HostedBoard, clock: BoardClock, on_step: Callable[[], None], time: Time) -> None:
        self._board = board
        self._clock = clock
        self._on_step = on_step
        self._time = time
        self.line: Transport | None = None

    async def meanwhile(self, wanted: Coroutine[Any, Any, T]) -> T:
        """Wait for something while the board does what falls due."""
        task = asyncio.ensure_future(wanted)
        try:
            while not task.done():
                await asyncio.wait({task}, timeout=self._pass_time())
        finally:
            task.cancel()
            # Seen to its end: a read left running would take what the next one is to hear.
            await asyncio.gather(task, return_exceptions=True)
        return task.result()

    def hear(self, data: bytes) -> None:
        """Hand bytes to the board."""
        self._board.receive(data, self._now_us())
        self._speak()

    def _pass_time(self) -> float | None:
        """Let the board catch up and return how long it may sleep [s]; None: until it hears something."""
        self._board.advance(self._now_us())
        self._speak()
        due_us = self._board.next_event_us
        if due_us is None:
            return None
        return self._time.wait_s(self._clock.true_us(due_us) * _NS_PER_US)

    def _speak(self) -> None:
        said = self._board.take_output()
        if said and self.line is not None:
            with contextlib.suppress(TransportError):  # full: lost, as on a real line; gone: reading will tell
                self.line.write(said)
        self._on_step()

    def _now_us(self) -> int:
        return self._clock.board_us(self._time.now_ns() // _NS_PER_US)
