"""A line that loses, repeats, garbles and dies as it is told."""

from collections.abc import Callable

from firmware_proto.framing import Deframer, RawFrame, encode_frame
from firmware_proto.schema import Message
from robotd.hardware.transport.transport import Transport

Choice = Callable[[RawFrame], int]
"""How often a frame is passed on."""


def once(_: RawFrame) -> int:
    return 1


def as_it_is(frame: RawFrame) -> RawFrame:
    return frame


def never(_: RawFrame) -> int:
    return 0


def lose(count: int, code: int) -> Choice:
    """Lose the first ``count`` frames of a type."""
    left = [count]

    def choose(frame: RawFrame) -> int:
        if frame.type == code and left[0]:
            left[0] -= 1
            return 0
        return 1

    return choose


class FaultyLine:
    """A transport that passes each frame as often as it is told to, and garbles as many stops as it is told to."""

    def __init__(self, line: Transport) -> None:
        self.name = line.name
        self.to_board: Choice = once
        self.from_board: Choice = once
        self.lie: Callable[[RawFrame], RawFrame] = as_it_is
        """What the board says in place of what it should, checksums being right."""
        self.noise: Callable[[], bytes] = bytes
        self.garbled_stops = 0
        self.sent: list[RawFrame] = []
        self._line = line
        self._deframer = Deframer()

    async def read(self) -> bytes:
        while True:
            frames = self._deframer.feed(await self._line.read())
            if kept := b"".join(self.noise() + encode_frame(self.lie(one)) * self.from_board(one) for one in frames):
                return kept

    def write(self, data: bytes) -> None:
        for frame in Deframer().feed(data):
            self.sent.append(frame)
            self._line.write((self.noise() + data) * self.to_board(frame))

    def write_urgent(self, data: bytes) -> None:
        self.sent.extend(Deframer().feed(data))
        self._line.write_urgent(data[:-3] if self.garbled_stops else data)
        self.garbled_stops = max(0, self.garbled_stops - 1)

    def write_past_loop(self, data: bytes) -> None:
        self._line.write_past_loop(data)

    def close(self) -> None:
        self._line.close()

    def count(self, message: type[Message]) -> int:
        return sum(frame.type == message.TYPE for frame in self.sent)
