"""Faults of plugs and power: the line itself is gone, or somebody else is at its end."""

from robotd.core.errors import TransportError
from robotd.hardware.link.tap import Direction
from robotd.hardware.transport.transport import Transport
from robotd.sim.faults.fault import CableEnd, Fault, deliver


class Unplug(Fault):
    """The plug is pulled; when it is over it is back, under another name of the system's."""

    def begin(self, line: CableEnd) -> None:
        """Pull it."""
        line.unplug()

    def end(self, line: CableEnd) -> None:
        """Put it back."""
        super().end(line)
        line.plug()


class Replug(Fault):
    """The plug is pulled and at once back, under another name of the system's."""

    def begin(self, line: CableEnd) -> None:
        """Pull it, and put it back."""
        line.unplug()
        line.plug()


class WrongIdentity(Fault):
    """Another device answers on this port."""

    def begin(self, line: CableEnd) -> None:
        """Plug another one in."""
        line.exchange(stranger=True)

    def end(self, line: CableEnd) -> None:
        """Plug the right one in."""
        super().end(line)
        line.exchange(stranger=False)


class WriteFails(Fault):
    """A write is refused by the system (EIO), and the line is gone; so it goes with each new line."""

    refuses_writes = True

    async def pass_on(self, data: bytes, way: Direction, sink: Transport) -> None:
        """Break the line with the first byte that the host writes."""
        if way is Direction.TO_BOARD:
            raise TransportError(f"{sink.name}: write: Input/output error")
        deliver(data, sink)


class Reboot(Fault):
    """The board loses its power for a moment."""

    def begin(self, line: CableEnd) -> None:
        """Take it away."""
        line.reboot()
