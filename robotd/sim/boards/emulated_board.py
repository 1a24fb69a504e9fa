"""What every emulated board does: handshake, states, repeats, arming, deadman, telemetry.

A board is a peer of the host without I/O: bytes and times go in, bytes come out. It does what
``firmware_proto/PROTOCOL.md`` demands of firmware, and nothing a microcontroller could not.
"""

import zlib
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from typing import Any

from firmware_proto.common import (
    DICTIONARY_CHUNK,
    PROTOCOL_MAJOR,
    PROTOCOL_MINOR,
    Arm,
    BoardKind,
    BoardState,
    BoardStatus,
    Clear,
    Configure,
    ConfigureReply,
    Disarm,
    Fault,
    Hello,
    HelloReply,
    Identify,
    IdentifyReply,
    Kill,
    Ping,
    Pong,
    Result,
    Stop,
)
from firmware_proto.dictionary import REQUEST_END, dictionary_for, requests_for
from firmware_proto.framing import Deframer, RawFrame
from firmware_proto.rules import RULES
from firmware_proto.schema import Message, payload_size
from robotd.sim.boards.board_outbox import BoardOutbox

Outcome = Message | Result | None
"""Of a request: its own reply, or a result (``Ack`` or NACK), or None while the reply must wait."""
Handler = Callable[[Any, int], Outcome]
"""Executes a request, given it and its seq."""

_COUNTER_SPAN = 1 << 16
_CLOCK_HZ = 1_000_000


class Board(ABC):
    """The part that all boards share; a device adds its requests, its events and its reports."""

    def __init__(self, kind: BoardKind, handlers: dict[type[Message], Handler], *, boot_id: int) -> None:
        self._dictionary = dictionary_for(kind)
        self._requests = requests_for(kind)
        common: dict[type[Message], Handler] = {
            Hello: self._hello,
            Ping: self._ping,
            Identify: self._identify,
            Configure: self._configure,
            Arm: self._arm,
            Disarm: self._disarm,
            Clear: self._clear,
            Stop: self._stop,
            Kill: self._kill,
        }
        self._handlers = common | handlers
        self._now_us = 0
        self._boot(boot_id)

    def _boot(self, boot_id: int) -> None:
        self._boot_id = boot_id
        self._deframer = Deframer()
        self._wrong_sizes = 0
        self._beneath = BoardState.BOOT
        self._faults = Fault.NONE
        self._told: tuple[BoardState, Fault] | None = None
        self._outbox = BoardOutbox()
        self._period_us = 0
        self._telemetry_us: int | None = None
        self._ttl_max_ms = 0
        self._deadline_us: int | None = None

    # What the wire sees

    def receive(self, data: bytes, now_us: int) -> None:
        """Take bytes from the host, at the board's time."""
        self.advance(now_us)
        for frame in self._deframer.feed(data):
            self._answer(frame)
            self._observe()
            self._tell_change()  # after the answer to what changed it (PROTOCOL.md)

    def advance(self, now_us: int) -> None:
        """Let time pass; what falls due on the way happens in order, each at its own time."""
        while (due_us := self.next_event_us) is not None and due_us <= now_us:
            self._pass_time(due_us)
        if now_us > self._now_us:
            self._pass_time(now_us)

    def take_output(self) -> bytes:
        """Return, once, the bytes that the board has for the host."""
        return self._outbox.take()

    @property
    def next_event_us(self) -> int | None:
        """When :meth:`advance` must be called at the latest; None while nothing is under way."""
        return min((at for at in self._events_us() if at is not None), default=None)

    @property
    def state(self) -> BoardState:
        """Where in its life the board is; ``FAULT`` lies over the state beneath it."""
        return BoardState.FAULT if self._faults else self._beneath

    @property
    def faults(self) -> Fault:
        """The latched faults."""
        return self._faults

    def reboot(self, boot_id: int) -> None:
        """Lose power and come back: motors cut, everything forgotten, bytes under way lost."""
        self._cut()
        self._boot(boot_id)

    # What a device adds

    @abstractmethod
    def _halt(self) -> None:
        """Ramp down, switch off."""

    @abstractmethod
    def _cut(self) -> None:
        """Stop at once, switch off."""

    @abstractmethod
    def _advance_plant(self, to_us: int) -> None:
        """Let time pass beneath the board."""

    @abstractmethod
    def _observe(self) -> None:
        """Look at the plant now: what was done, what was hit."""

    @abstractmethod
    def _reports(self) -> tuple[Message, ...]:
        """Return the device's periodic telemetry."""

    def _events_us(self) -> Iterator[int | None]:
        """Yield when something falls due; a device adds its own."""
        yield self._telemetry_us
        yield self._deadline_us

    # Time

    def _pass_time(self, to_us: int) -> None:
        self._now_us = to_us
        self._advance_plant(to_us)
        self._observe()
        # The deadman before the telemetry: what is told at a moment holds at that moment.
        if self._deadline_us is not None and self._deadline_us <= to_us:
            self._latch(Fault.DEADMAN)
        if self._telemetry_us is not None and self._telemetry_us <= to_us:
            self._telemetry_us += self._period_us  # on its grid: a late call does not shift it
            self._outbox.tell(self._status())
            for report in self._reports():
                self._outbox.tell(report)
        self._tell_change()

    def _grant(self, ttl_ms: int) -> None:
        """Start the deadman: unless renewed or ended by then, the motion is a fault."""
        self._deadline_us = self._now_us + min(ttl_ms, self._ttl_max_ms) * 1000

    def _tell_change(self) -> None:
        if self._outbox.telling and (self.state, self._faults) != self._told:
            self._outbox.tell(self._status())

    def _status(self) -> BoardStatus:
        self._told = (self.state, self._faults)
        return BoardStatus(
            self._now_us,
            self.state,
            self._faults,
            self._deframer.crc_errors % _COUNTER_SPAN,
            self._deframer.cobs_errors % _COUNTER_SPAN,
            (self._deframer.length_errors + self._wrong_sizes) % _COUNTER_SPAN,
        )

    # Requests

    def _answer(self, frame: RawFrame) -> None:
        request = self._requests.get(frame.type)
        if request is None:
            if frame.type < REQUEST_END:
                self._outbox.reply(frame.type, frame.seq, Result.UNKNOWN_TYPE)
            return
        if len(frame.payload) != payload_size(request):
            self._wrong_sizes += 1
            self._outbox.reply(frame.type, frame.seq, Result.BAD_LENGTH)
            return
        self._answer_once(request.from_payload(frame.payload), frame.seq)

    def _answer_once(self, request: Message, seq: int) -> None:
        rule = RULES[type(request)]
        if self._outbox.repeat(request.TYPE, seq):
            return
        allowed = rule.allows(self._beneath, faulted=bool(self._faults))
        outcome = self._handlers[type(request)](request, seq) if allowed else Result.WRONG_STATE
        wire = b"" if outcome is None else self._outbox.reply(request.TYPE, seq, outcome)
        # BUSY is not kept: asked again later, the same request may be done (PROTOCOL.md).
        if rule.deduplicated and outcome is not Result.BUSY:
            self._outbox.remember(request.TYPE, seq, wire)

    def _answer_late(self, request: type[Message], seq: int, reply: Message) -> None:
        self._outbox.remember(request.TYPE, seq, self._outbox.reply(request.TYPE, seq, reply))

    def _hello(self, hello: Hello, seq: int) -> Outcome:
        self._rest()
        self._beneath = BoardState.IDENTIFIED if hello.major == PROTOCOL_MAJOR else BoardState.BOOT
        self._telemetry_us = None
        self._outbox.new_session()
        size, crc = len(self._dictionary), zlib.crc32(self._dictionary)
        return HelloReply(PROTOCOL_MAJOR, PROTOCOL_MINOR, hello.nonce, size, crc, self._boot_id, _CLOCK_HZ)

    def _ping(self, ping: Ping, seq: int) -> Outcome:
        return Pong(ping.host_us, self._now_us)

    def _identify(self, identify: Identify, seq: int) -> Outcome:
        return IdentifyReply(identify.offset, self._dictionary[identify.offset :][:DICTIONARY_CHUNK])

    def _configure(self, configure: Configure, seq: int) -> Outcome:
        if not configure.telemetry_ms or not configure.ttl_max_ms:
            return Result.BAD_VALUE
        self._rest()
        self._beneath = BoardState.CONFIGURED
        self._period_us = configure.telemetry_ms * 1000
        self._telemetry_us = self._now_us + self._period_us
        self._outbox.telling = True
        self._told = None  # so that a status follows at once
        self._ttl_max_ms = configure.ttl_max_ms
        return ConfigureReply(Result.OK, zlib.crc32(configure.to_payload()))

    def _arm(self, arm: Arm, seq: int) -> Outcome:
        self._beneath = BoardState.ARMED
        return Result.OK

    def _disarm(self, disarm: Disarm, seq: int) -> Outcome:
        self._rest()
        return Result.OK

    def _clear(self, clear: Clear, seq: int) -> Outcome:
        self._rest()
        self._faults = Fault.NONE
        return Result.OK

    def _stop(self, stop: Stop, seq: int) -> Outcome:
        self._rest()
        return Result.OK

    def _kill(self, kill: Kill, seq: int) -> Outcome:
        self._latch(Fault.KILLED, cut=True)
        return Result.OK

    # Coming to rest

    def _rest(self, *, cut: bool = False) -> None:
        """Disarm and bring the device to rest."""
        self._deadline_us = None
        if self._beneath is BoardState.ARMED:
            self._beneath = BoardState.CONFIGURED
        if cut:
            self._cut()
        else:
            self._halt()

    def _latch_broken(self, broken: Fault) -> None:
        """Latch what is wrong beneath and not latched yet; a broken motor must not be ramped."""
        newly = broken & ~self._faults
        if newly:
            self._latch(newly, cut=Fault.MOTOR in newly)

    def _latch(self, fault: Fault, *, cut: bool = False) -> None:
        self._faults |= fault
        self._rest(cut=cut)
