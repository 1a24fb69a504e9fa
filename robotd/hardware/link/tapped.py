"""A line with a tap on it: every byte, both ways, with its time."""

from dataclasses import dataclass

from robotd.core.attention import attention
from robotd.core.clock import now_ns
from robotd.core.errors import TransportError
from robotd.hardware.link.tap import Direction, Tap
from robotd.hardware.transport.transport import Transport


@dataclass(frozen=True, slots=True)
class Chunk:
    """Bytes as they came, and when.

    Anyone who needs the time of a message takes it from here, never from the clock: it is the time that the
    tap saw, so a recording gives the same times back.
    """

    time_ns: int
    data: bytes


class TappedLine:
    """An open transport whose traffic the tap sees."""

    def __init__(self, device: str, transport: Transport, tap: Tap) -> None:
        """Take over an open transport; the tap is told that the line is up."""
        self._device = device
        self._transport = transport
        self._tap = tap
        self._is_open = True
        tap.line_changed(device, now_ns(), up=True)

    async def read(self) -> Chunk:
        """Return the next bytes; TransportError when the line is gone."""
        try:
            data = await self._transport.read()
        except TransportError as error:
            self._tap.line_broke(self._device, now_ns(), str(error))
            raise
        # Before these bytes get their time: a stall is noted ahead of all that came after it, here and in a replay.
        attention().look()
        chunk = Chunk(now_ns(), data)
        self._tap.bytes_passed(self._device, Direction.FROM_BOARD, chunk.time_ns, data)
        return chunk

    def write(self, data: bytes) -> None:
        """Queue bytes; TransportError when the line is gone or its buffer is full."""
        try:
            self._transport.write(data)
        except TransportError as error:
            self._tap.line_broke(self._device, now_ns(), str(error))
            raise
        finally:  # what a broken line would not take was asked for all the same, and a replay asks for it
            self._tap.bytes_passed(self._device, Direction.TO_BOARD, now_ns(), data)

    def write_urgent(self, data: bytes) -> None:
        """Queue bytes in place of everything not yet written; TransportError when the line is gone."""
        try:
            self._transport.write_urgent(data)
        except TransportError as error:
            if self._is_open:  # a stop may come after the line was given up
                self._tap.line_broke(self._device, now_ns(), str(error))
            raise
        finally:  # as above
            self._tap.bytes_passed(self._device, Direction.TO_BOARD, now_ns(), data)

    def write_past_loop(self, data: bytes) -> None:
        """Write bytes at once, from any thread; never raises. The tap does not see them: it lives on the loop."""
        self._transport.write_past_loop(data)

    def close(self) -> None:
        """Give the line up; the tap is told once."""
        self._transport.close()
        if self._is_open:
            self._is_open = False
            self._tap.line_changed(self._device, now_ns(), up=False)
