"""A host for one emulated board, with a clock that moves only when told."""

from firmware_proto.common import Arm, BoardKind, BoardState, Configure, Hello
from firmware_proto.schema import Message
from robotd.hardware.wire.board import BoardWire, Received
from robotd.sim.boards.emulated_board import Board

START_US = 1_000_000


class Host:
    """The other end of the line; arms the board, then says and hears what the test wants."""

    def __init__(self, board: Board, kind: BoardKind, *, telemetry_ms: int = 60_000, ttl_max_ms: int = 5000) -> None:
        self.board = board
        self.wire = BoardWire(kind)
        self.now_us = START_US
        self._seq = 99
        for request in (Hello(1, 0, 1), Configure(telemetry_ms, ttl_max_ms), Arm()):
            self.say(request)

    def say(self, request: Message, seq: int | None = None) -> list[Message]:
        self._seq += seq is None
        self.board.receive(self.wire.encode(request, self._seq if seq is None else seq), self.now_us)
        return self.heard()

    def wait(self, ms: float) -> list[Message]:
        self.now_us += round(ms * 1000)
        self.board.advance(self.now_us)
        return self.heard()

    def heard(self) -> list[Message]:
        return [one.message for one in self.received()]

    def received(self) -> list[Received]:
        return self.wire.feed(self.board.take_output())

    def state(self) -> BoardState:
        return self.board.state
