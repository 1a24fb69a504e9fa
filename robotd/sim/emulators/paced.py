"""What a device says takes time on the line: this many bits a byte, at the speed of the line."""

from collections import deque

from robotd.hardware.transport.line_format import LineFormat
from robotd.sim.hosting.host import HostedBoard

_US_PER_S = 1_000_000


class Paced:
    """An emulator whose words leave it no faster than its line carries them, one line-time for each byte.

    Without it an emulator in memory would answer at once, and a host that asks and asks would stop the virtual clock.
    """

    def __init__(self, device: HostedBoard, line: LineFormat) -> None:
        self.device = device
        bits = 1 + line.data_bits + (line.parity != "N") + line.stop_bits
        self._byte_us = max(1, round(bits * _US_PER_S / line.baud))
        self._under_way: deque[tuple[int, bytes]] = deque()
        self._line_free_us = 0
        self._now_us = 0

    def receive(self, data: bytes, now_us: int) -> None:
        """Take bytes from the host."""
        self._now_us = now_us
        self.device.receive(data, now_us)
        self._send()

    def advance(self, now_us: int) -> None:
        """Let time pass."""
        self._now_us = now_us
        self.device.advance(now_us)
        self._send()

    @property
    def next_event_us(self) -> int | None:
        """When something falls due, or arrives."""
        arrives_us = self._under_way[0][0] if self._under_way else None
        return min((at for at in (self.device.next_event_us, arrives_us) if at is not None), default=None)

    def take_output(self) -> bytes:
        """Return, once, what has arrived."""
        arrived = bytearray()
        while self._under_way and self._under_way[0][0] <= self._now_us:
            arrived += self._under_way.popleft()[1]
        return bytes(arrived)

    def _send(self) -> None:
        said = self.device.take_output()
        if said:
            # Behind what is still under way: a line carries one byte at a time.
            self._line_free_us = max(self._line_free_us, self._now_us) + len(said) * self._byte_us
            self._under_way.append((self._line_free_us, said))
