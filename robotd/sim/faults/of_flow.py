"""Faults of the flow: too little, too much, too slow."""

from robotd.hardware.link.tap import Direction
from robotd.hardware.transport.transport import Transport
from robotd.sim.faults.fault import Fault, deliver

_DRIP_S = 0.02
_FLOOD_EVERY_S = 0.02
_FLOOD_BYTES = 2000
"""At once; with the above, 100 kB/s: nine times what a line of 115200 baud can carry."""


class SilentLine(Fault):
    """Nothing comes from the board, which hears everything."""

    def changed(self, data: bytes, way: Direction) -> bytes:
        """Return nothing of what the board says."""
        return b"" if way is Direction.FROM_BOARD else data


class Blocked(Fault):
    """The board takes no bytes: they wait in the buffers of the host until those are full."""

    async def pass_on(self, data: bytes, way: Direction, sink: Transport) -> None:
        """Hold what goes to the board until it is over."""
        if way is Direction.TO_BOARD:
            await self._over.wait()
        deliver(data, sink)


class Drip(Fault):
    """What the board says comes a byte at a time, fifty a second; what does not fit into its buffer is lost."""

    async def pass_on(self, data: bytes, way: Direction, sink: Transport) -> None:
        """Deliver what the board says byte by byte, and the rest at once when it is over."""
        if way is Direction.TO_BOARD:
            deliver(data, sink)
            return
        while data and not self._is_over:
            deliver(data[:1], sink)
            data = data[1:]
            await self._pause(_DRIP_S)
        deliver(data, sink)


class Flood(Fault):
    """Noise pours in between what the board says, nine times as fast as a serial line can."""

    async def disturb(self, host: Transport, board: Transport) -> None:
        """Pour; what the host does not take in time is lost."""
        while not self._is_over:
            deliver(self._rng.randbytes(_FLOOD_BYTES), host)
            await self._pause(_FLOOD_EVERY_S)
