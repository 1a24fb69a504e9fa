"""A cable between a host and a board, on which anything can go wrong.

Theory of operation: the host has one end, the board another, and the cable carries the bytes from one to the other
through the fault of the moment, which may change, delay or swallow them. A plug that is pulled closes the host's end;
with each new one the board finds a new line, as it does when a host opens the port again.
"""

import asyncio
import random
from collections.abc import Callable
from typing import NoReturn

from robotd.core.errors import ConfigError, TransportError
from robotd.core.together import ended
from robotd.hardware.link.tap import Direction
from robotd.hardware.transport.memory import memory_pair
from robotd.hardware.transport.transport import Connect, Transport
from robotd.sim.faults.fault import Fault


class Cable:
    """The cable of one device; :meth:`run` carries its bytes."""

    def __init__(
        self,
        device: str,
        board: Connect,
        *,
        stranger: Connect,
        reboot: Callable[[], None] | None = None,
        on_plug: Callable[[bool], None] = lambda _: None,
    ) -> None:
        """Lay it.

        Args:
            device: what it is called, for people.
            board: opens a line to the board.
            stranger: opens a line to another device, which does not belong here.
            reboot: takes the board's power away for a moment, if that can be done.
            on_plug: told when a name must go, as the plug was pulled (False), or lead to a new line (True).
        """
        self._device = device
        self._board = board
        self._stranger = stranger
        self._reboot = reboot
        self._on_plug = on_plug
        self._hosts: asyncio.Queue[Transport] = asyncio.Queue()
        self._host: Transport | None = None
        self._is_exchanged = False
        self._plugs = 0
        self.is_plugged = True
        self.fault: Fault = Fault(random.Random(0))

    # The host's side

    async def connect(self) -> Transport:
        """Return the host's end of a new line, in memory.

        Raises:
            TransportError: the plug is pulled.
        """
        if not self.is_plugged:
            raise TransportError(f"{self._device}: no such device")
        near, far = memory_pair(self._device if not self._plugs else f"{self._device} ({self._plugs})")
        self.put(far)
        return _Plug(near, self)

    def put(self, host: Transport) -> None:
        """Take over the far end of a line to the host; the cable closes it in the end."""
        self._hosts.put_nowait(host)

    @property
    def can_reboot(self) -> bool:
        """Whether the board's power can be taken away."""
        return self._reboot is not None

    # What a fault may do

    def set_fault(self, fault: Fault) -> None:
        """End the fault of the moment and begin another."""
        before, self.fault = self.fault, fault
        before.end(self)
        fault.begin(self)

    def mend(self) -> None:
        """End the fault of the moment."""
        self.set_fault(Fault(random.Random(0)))

    def unplug(self) -> None:
        """Pull the plug at the host's side."""
        self.is_plugged = False
        while not self._hosts.empty():  # lines opened and not served yet go with the plug
            self._hosts.get_nowait().close()
        if self._host is not None:
            self._host.close()
        self._on_plug(False)

    def plug(self) -> None:
        """Put it back, under another name of the system's."""
        self.is_plugged = True
        self._plugs += 1
        self._on_plug(True)

    def exchange(self, *, stranger: bool) -> None:
        """Pull the plug and plug another device in, or the right one again."""
        self.unplug()
        self._is_exchanged = stranger
        self.plug()

    def reboot(self) -> None:
        """Take the board's power away, and give it back.

        Raises:
            ConfigError: this board cannot do that.
        """
        if self._reboot is None:
            raise ConfigError("only our own boards can be rebooted", key=self._device)
        self._reboot()

    # What it carries

    async def run(self) -> NoReturn:
        """Carry bytes for one host's end after the other, until cancelled."""
        while True:
            self._host = await self._hosts.get()
            try:
                await self._serve(self._host)
            finally:
                self._host.close()
                self._host = None
            if self.is_plugged and self._hosts.empty():
                self._on_plug(True)  # the line broke, the plug did not come out

    async def _serve(self, host: Transport) -> None:
        board = await (self._stranger if self._is_exchanged else self._board)()
        carrying = {
            asyncio.create_task(self._carry(host, board, Direction.TO_BOARD)),
            asyncio.create_task(self._carry(board, host, Direction.FROM_BOARD)),
            asyncio.create_task(self._disturb(host, board)),
        }
        try:
            await asyncio.wait(carrying, return_when=asyncio.FIRST_COMPLETED)
        finally:
            errors = await ended(carrying)
            board.close()
        for error in errors:
            # That a line ends is what cables are for; all else is a mistake of ours.
            if not isinstance(error, TransportError):
                raise error

    async def _carry(self, source: Transport, sink: Transport, way: Direction) -> NoReturn:
        while True:
            data = await source.read()
            await self.fault.pass_on(data, way, sink)

    async def _disturb(self, host: Transport, board: Transport) -> NoReturn:
        while True:
            await self.fault.disturb(host, board)


class _Plug:
    """The host's end in memory, whose writes can be refused."""

    def __init__(self, line: Transport, cable: Cable) -> None:
        self._line = line
        self._cable = cable

    @property
    def name(self) -> str:
        return self._line.name

    async def read(self) -> bytes:
        return await self._line.read()

    def write(self, data: bytes) -> None:
        self._check()
        self._line.write(data)

    def write_urgent(self, data: bytes) -> None:
        self._check()
        self._line.write_urgent(data)

    def write_past_loop(self, data: bytes) -> None:
        self._line.write_past_loop(data)

    def close(self) -> None:
        self._line.close()

    def _check(self) -> None:
        # The error takes the line with it: closed here, reading finds it dead as well.
        if self._cable.fault.refuses_writes:
            self._line.close()
            raise TransportError(f"{self.name}: write: Input/output error")
