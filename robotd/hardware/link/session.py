"""One conversation with one board: requests, retries, set-points, telemetry, clock.

Theory of operation. A reader task takes every frame. Telemetry goes to the one who asked for it; a reply
settles the request under way if type and seq fit, and is otherwise only counted. One request is under way at a time,
repeated with the same seq until it is answered, so a board executes it once. What happens is caused by
messages alone; timers only bound silence: of a request, and of the line.
"""

import asyncio
import logging
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from types import TracebackType
from typing import Any, NoReturn, Self, TypeVar

from firmware_proto.common import Arm, BoardState, BoardStatus, Ping, Pong, Result
from firmware_proto.dictionary import TELEMETRY_END, TELEMETRY_START
from firmware_proto.schema import Message
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import DeviceError, LinkTimeout, RemoteProtocolError, RobotdError, TransportError
from robotd.core.silence import within
from robotd.core.together import ended
from robotd.hardware.link.clock_sync import AHEAD_MAX_NS, ClockSync
from robotd.hardware.link.pending_request import PendingRequest, answered_type, result_of
from robotd.hardware.link.round_trip import RoundTrip
from robotd.hardware.link.tapped import TappedLine
from robotd.hardware.wire.board import EMERGENCY_SEQ, STOP_BYTES, BoardWire, Received

TRIES = 3
"""At least, as PROTOCOL.md has it; all bear the same seq, so a board does once what it hears three times."""
_PING_EVERY_S = 1.0
"""As PROTOCOL.md has it; between two the clocks run apart by far less than a round trip is uncertain."""
_NS_PER_US = 1000

log = logging.getLogger(__name__)

Answer = TypeVar("Answer", bound=Message)
TelemetryHandler = Callable[[Message], None]


@dataclass(slots=True)
class LinkCounters:
    """What the link counted since start, beside what the wire counts."""

    sessions: int = 0
    retries: int = 0
    timeouts: int = 0
    """Requests that no try got answered."""
    refused: int = 0
    """Set-points that the board would not take."""
    unmatched: int = 0
    """Replies to nothing that was asked: repeats, mostly."""
    implausible: int = 0
    """Values that cannot be, in frames whose checksum was right."""


class Session:
    """A conversation over an open line, as a context manager; it ends when the line is lost or the block is left."""

    def __init__(
        self,
        device: str,
        line: TappedLine,
        wire: BoardWire,
        *,
        counters: LinkCounters,
        on_telemetry: TelemetryHandler,
        silence_s: float,
    ) -> None:
        self.device = device
        self.clock = ClockSync()
        self.boot_id = 0
        """Told by the handshake."""
        self.heard_ns = now_ns()
        """When the last frame came."""
        self._line = line
        self._wire = wire
        self._counters = counters
        self._on_telemetry = on_telemetry
        self._silence_s = silence_s
        self._seqs: Counter[type[Message]] = Counter()
        self._round_trips: dict[type[Message], RoundTrip] = {}
        self._one_at_a_time = asyncio.Lock()
        self._request: PendingRequest | None = None
        self._posted: set[int] = set()
        """Types of request whose replies are only counted."""
        self._serving = False
        """Whether the handshake is over: from then on telemetry is the sign of life."""
        self._stops = 0
        self._board_us = 0
        """Newest time that its status bore: one that goes back is a restart."""
        self._is_unlearned = False
        """Whether it was logged already: a clock that cannot learn is news once, not each second."""
        self._lost: RobotdError | None = None
        self._pinging: asyncio.Handle
        """Of what comes next: the next ping, or that the last one could not be sent."""

    async def __aenter__(self) -> Self:
        self._reader = asyncio.create_task(self._read(), name=f"{self.device} reader")
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await ended((self._reader,))  # what it raised is known already, or of no interest any more
        self._lose(TransportError(f"{self.device}: the session is over"))

    # What a device may do

    async def ask(self, message: Message, answer: type[Answer], *, takes_s: float = 0.0) -> Answer:
        """Send a request and return its reply; ``takes_s`` is how long the board may need to find it.

        Raises:
            DeviceError: the board refused; the code is its result in lower case.
            LinkTimeout: no answer to any try.
            TransportError: the line is lost, or was lost meanwhile.
        """
        reply = (await self._exchange(message, takes_s)).message
        if not isinstance(reply, answer):
            raise RemoteProtocolError(f"{self.device}: answered {message} with {reply}")
        return reply

    async def command(self, message: Message) -> int:
        """Send a request that is only acknowledged, and return its seq; same errors as :meth:`ask`."""
        return (await self._exchange(message, 0.0)).seq

    def post(self, message: Message) -> None:
        """Send a set-point: new seq each time, never repeated, its reply only counted.

        Raises:
            TransportError: the line is lost, or stuck.
        """
        self._check()
        self._posted.add(message.TYPE)
        self._line.write(self._wire.encode(message, self._next_seq(message)))

    def stop_now(self) -> None:
        """Put the preformatted stop on the wire in place of everything not yet written; never raises.

        An ARM that waits for its answer, or for its turn, is given up: it must not come after the stop.
        """
        self._stops += 1
        if self._request is not None and isinstance(self._request.message, Arm):
            self._request.fail(self._stopped())
        try:
            self._line.write_urgent(STOP_BYTES)
        except TransportError:
            return  # the board's own deadman stops it

    def stop_past_loop(self) -> None:
        """Put the preformatted stop on the wire from any thread, while the loop is stuck; never raises."""
        self._line.write_past_loop(STOP_BYTES)

    async def ping(self) -> None:
        """Ask for the board's time and learn from the answer; same errors as :meth:`ask`."""
        await self.ask(_ping(), Pong)

    async def serve(self) -> NoReturn:
        """Hand telemetry on and keep the clock until the session is void; raise why.

        Raises:
            TransportError: the line is lost.
            LinkTimeout: no telemetry came for ``silence_s``.
            RemoteProtocolError: the board restarted, or somebody else opened a session with it.
        """
        self._serving = True
        unsaid: asyncio.Future[Exception] = asyncio.get_running_loop().create_future()
        self._ping_again(unsaid)
        ends: set[asyncio.Future[Any]] = {self._reader, unsaid}
        try:
            # No timer here: a ping that falls due as the line breaks must not hasten the end by a turn, or a replay,
            # whose timers fire later, would hear of it in another order.
            await asyncio.wait(ends, return_when=asyncio.FIRST_COMPLETED)
        finally:
            self._pinging.cancel()
        if self._reader.done():
            self._reader.result()
        raise unsaid.result()

    def _ping_again(self, unsaid: "asyncio.Future[Exception]") -> None:
        loop = asyncio.get_running_loop()
        self._pinging = loop.call_later(_PING_EVERY_S, self._ping_again, unsaid)
        try:
            self.post(_ping())
        except Exception as error:
            # A turn later, as the reader hears of a line that is lost.
            self._pinging.cancel()
            self._pinging = loop.call_soon(unsaid.set_result, error)

    # Requests

    async def _exchange(self, message: Message, takes_s: float) -> Received:
        # Before the lock: a stop that comes while this waits for its turn counts.
        stops = self._stops
        async with self._one_at_a_time:
            self._check()
            # Arm alone: after a stop the board itself refuses whatever else would move it.
            if isinstance(message, Arm) and self._stops != stops:
                raise self._stopped()
            request = self._request = PendingRequest(self.device, message, self._next_seq(message))
            began_ns = now_ns()
            try:
                reply = await self._repeat_until_answered(request, takes_s)
            finally:
                self._request = None
            # By the kind of request: a board reads its dictionary from flash, and answers a ping from memory.
            self._round_trip(message).add((now_ns() - began_ns) / NS_PER_S)
            return reply

    async def _repeat_until_answered(self, request: PendingRequest, takes_s: float) -> Received:
        data = self._wire.encode(request.message, request.seq)
        began_ns = sent_ns = now_ns()
        attempt = 0
        # The last try is sent no sooner than the line has to be heard again: one of before may have gone unheard.
        while attempt < TRIES or self._may_answer_late(began_ns, sent_ns):
            self._counters.retries += attempt > 0
            sent_ns = now_ns()
            self._line.write(data)
            # A slow answer is waited for after the last sure try only: the board is at work on it, to ask again does no
            # harm, and a request that was lost is found out sooner.
            patience_s = takes_s if attempt >= TRIES - 1 else 0.0
            reply = await request.wait(self._round_trip(request.message).timeout_s(attempt) + patience_s)
            if reply is not None:
                return reply
            attempt += 1
        self._counters.timeouts += 1
        raise LinkTimeout(f"{self.device}: no answer to {type(request.message).__name__} in {attempt} tries")

    def _may_answer_late(self, began_ns: int, sent_ns: int) -> bool:
        """Say whether to ask on after a try: for as long as the line may be silent, one may stay without its answer.

        A board that gets no processor for a while is late with both, and to be late is no failure. One that is lost is
        found out by the reader, sooner.
        """
        return self._serving and (sent_ns - began_ns) / NS_PER_S < self._silence_s

    def _round_trip(self, message: Message) -> RoundTrip:
        return self._round_trips.setdefault(type(message), RoundTrip())

    def _next_seq(self, message: Message) -> int:
        # Leaves out the seq of the preformatted stop, whose answers must match no request.
        seq = self._seqs[type(message)] % EMERGENCY_SEQ
        self._seqs[type(message)] += 1
        return seq

    # Frames

    async def _read(self) -> NoReturn:
        try:
            # From the first message on: a booting board is silent longer, and the handshake has its own timeouts.
            async with within(self._silence_s, of=f"{self.device} line", begins=False) as silence:
                while True:
                    chunk = await self._line.read()
                    for received in self._wire.feed(chunk.data):
                        if self._take(received, chunk.time_ns):
                            silence.renew()
        except TimeoutError:
            raise self._lose(LinkTimeout(f"{self.device}: silent for {self._silence_s:g} s")) from None
        except RobotdError as error:
            raise self._lose(error) from error.__cause__

    def _take(self, received: Received, time_ns: int) -> bool:
        """Treat a frame; return whether it shows that the session lives.

        Once telemetry should come, replies do not: a board that restarted still answers pings.
        """
        self.heard_ns = time_ns
        message = received.message
        if isinstance(message, Pong):
            self._counters.implausible += not self._learn(message, time_ns)
        if not TELEMETRY_START <= received.type < TELEMETRY_END:
            self._settle(received)
            return not self._serving
        if self._serving:  # before, it may be telemetry of the session before ours
            self._check_ours(message)
            self._on_telemetry(message)
        return True

    def _learn(self, pong: Pong, time_ns: int) -> bool:
        try:
            agrees = self.clock.add(pong.host_us, pong.board_us, time_ns)
        except Exception:  # the clock goes on by what it learned before: no reason to lose the board
            if not self._is_unlearned:
                log.exception("%s: nothing was learned of its clock", self.device)
            self._is_unlearned = True
            return False
        self._is_unlearned = False
        return agrees

    def _settle(self, received: Received) -> None:
        if self._request is not None and self._request.is_answered_by(received):
            self._request.settle(received)
        elif answered_type(received) in self._posted or received.seq == EMERGENCY_SEQ:
            self._counters.refused += result_of(received.message) != Result.OK
        else:
            self._counters.unmatched += 1

    def _check_ours(self, message: Message) -> None:
        if not isinstance(message, BoardStatus):
            return
        # A boot begins its clock again; a HELLO that is not ours leaves the board unconfigured.
        if message.board_us < self._board_us or message.state < BoardState.CONFIGURED:
            raise RemoteProtocolError(f"{self.device}: the board restarted, or serves somebody else")
        # Only ahead: what waited in a buffer is late, but nothing is heard before it is said.
        ahead_ns = self.clock.ahead_ns(message.board_us, self.heard_ns)
        if ahead_ns > AHEAD_MAX_NS:
            self._counters.implausible += 1
            raise RemoteProtocolError(f"{self.device}: its clock jumped ahead by {ahead_ns / NS_PER_S:g} s")
        self._board_us = message.board_us

    def _check(self) -> None:
        if self._lost is not None:
            raise TransportError(str(self._lost))

    def _stopped(self) -> DeviceError:
        return DeviceError(self.device, "stopped", "while arming")

    def _lose(self, error: RobotdError) -> RobotdError:
        if self._lost is None:  # the first reason is the cause
            self._lost = error
        if self._request is not None:
            self._request.fail(TransportError(str(self._lost)))
        return error


def _ping() -> Ping:
    return Ping(now_ns() // _NS_PER_US)
