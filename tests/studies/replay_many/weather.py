"""What the machine and the lines do of themselves in a session, without anything being at fault."""

import asyncio
import random
from collections import defaultdict
from collections.abc import Callable

from robotd.core.clock import VirtualClockLoop
from robotd.hardware.link.tap import Direction
from robotd.hardware.transport.transport import Transport
from robotd.sim.faults.fault import Fault, deliver

_PIECES_MAX = 4
_BETWEEN_MAX_S = 0.003
_HELD_SHARE = 0.2
_TAKES_MAX_S = 0.4


class Rechunked(Fault):
    """Bytes arrive in other pieces than they were sent in: cut anywhere, and joined with what comes next."""

    def __init__(self, rng: random.Random) -> None:
        super().__init__(rng)
        self._held: defaultdict[Direction, bytes] = defaultdict(bytes)

    async def pass_on(self, data: bytes, way: Direction, sink: Transport) -> None:
        """Deliver all of it, though some of what a board says only with what it says next."""
        data = self._held.pop(way, b"") + data
        cuts = sorted(self._rng.randrange(len(data) + 1) for _ in range(self._rng.randrange(_PIECES_MAX)))
        pieces = [data[begin:end] for begin, end in zip([0, *cuts], [*cuts, len(data)], strict=True)]
        if way is Direction.FROM_BOARD and self._rng.random() < _HELD_SHARE:
            self._held[way] = pieces.pop()
        for piece in pieces:
            deliver(piece, sink)
            await self._pause(self._rng.choice((0.0, self._rng.uniform(0.0, _BETWEEN_MAX_S))))


class Slowly:
    """Computes one job after the other, each in a time of its own, as a worker thread does."""

    def __init__(self, rng: random.Random) -> None:
        self._rng = rng
        self._one_at_a_time = asyncio.Lock()

    async def run(self, name: str, function: Callable[..., object], *args: object) -> object:
        async with self._one_at_a_time:
            await asyncio.sleep(self._rng.uniform(0.0, _TAKES_MAX_S))
            return function(*args)


def block(seconds: float) -> None:
    """Let the loop stand still: timers fall due meanwhile, and what would have come waits."""
    loop = asyncio.get_running_loop()
    assert isinstance(loop, VirtualClockLoop)
    loop._jump(seconds)
