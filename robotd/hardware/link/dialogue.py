"""One conversation with a vendor device: requests one at a time, replies told apart by the dialect alone.

Makers' protocols have no sequence numbers, so a reply is known by what it looks like and by when it comes. Hence the
rules: one request is under way at a time; what does not settle it is handed on as a report; and once a request was
given up (no answer in time, or a stop came between) its answer may still come, so the next request waits until the line
has been quiet for a moment. So does the first one: a line just opened may bring answers to what somebody asked before.

What happens is caused by messages; timers only bound silence. A replay has only recorded moments, and fires a timer at
the first of them that is not before it: hence the wait for quiet is reckoned from messages and deadlines, never from
when a timer happened to fire, and a poll is sent only when nothing was answered for a while.
"""

import asyncio
import contextlib
import math
from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from types import TracebackType
from typing import Generic, NoReturn, Protocol, Self, TypeVar

from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import DeviceError, LinkTimeout, RobotdError, TransportError
from robotd.core.silence import idle, within
from robotd.core.together import ended
from robotd.hardware.link.tapped import TappedLine

M = TypeVar("M")
M_co = TypeVar("M_co", covariant=True)

_PIECES_MAX = 50
"""More than this since a request was given up, and the line counts as never quiet: one that streams, or is stuck."""
SILENCE_S = 1.0
"""So long an answer may stay out before the device is lost: as long as one that reports by itself may be silent, for
one that gets no processor for a while, or whose line does not, is late and not gone."""


class Wire(Protocol[M_co]):
    """The receiving half of a dialect: bytes in, messages out; damaged bytes are counted and skipped."""

    @property
    def counters(self) -> dict[str, int]:
        """What was counted since start, by name: messages, checksum errors, bytes skipped..."""

    def feed(self, data: bytes) -> Iterable[M_co]:
        """Take bytes as they come, in any pieces; return the messages that are whole now."""

    def reset(self) -> None:
        """Forget a message of which only the beginning came: the line was lost. Counters stay."""


@dataclass(frozen=True, slots=True)
class Heard(Generic[M]):
    """A message, and when its last byte came (clock of this host)."""

    message: M
    time_ns: int


@dataclass(slots=True)
class DialogueCounters:
    """What is counted since start, beside what the wire counts."""

    sessions: int = 0
    retries: int = 0
    timeouts: int = 0
    """Requests that no try got answered."""
    implausible: int = 0
    """Values that cannot be, in messages that were whole."""


@dataclass(slots=True)
class _Request(Generic[M]):
    settles: Callable[[M], bool]
    despite_stops: bool
    answer: "asyncio.Future[Heard[M]]" = field(default_factory=lambda: asyncio.get_running_loop().create_future())


class Dialogue(Generic[M]):
    """A conversation over an open line, as a context manager; it ends when the line is lost or the block is left."""

    def __init__(
        self,
        device: str,
        line: TappedLine,
        wire: Wire[M],
        *,
        counters: DialogueCounters,
        on_report: Callable[[Heard[M]], None],
        quiet_s: float = 0.05,
    ) -> None:
        """Begin on an open line.

        Args:
            device: for messages to people.
            line: nobody else reads from it.
            wire: the dialect.
            counters: shared by all conversations with this device.
            on_report: told every message that settles no request, in order.
            quiet_s: how long the line must have been quiet before the first request, and one that follows a stop or a
                request that was given up.
        """
        self._device = device
        self._line = line
        self._wire = wire
        self._counters = counters
        self._on_report = on_report
        self._quiet_s = quiet_s
        self._one_at_a_time = asyncio.Lock()
        self._request: _Request[M] | None = None
        self._stops = 0
        """Counted, so that a request sees that one came while it waited for its turn."""
        self._heard_ns = now_ns()
        self._answered_ns = self._heard_ns
        """When a request was last answered; bytes that answer nothing are no sign of life."""
        self._pieces_ns: deque[int] = deque(maxlen=_PIECES_MAX)
        """When the last pieces came."""
        self._unsettled_ns: int | None = self._heard_ns
        """When something was given up whose answer may still come; None if all is settled."""
        self._lost: RobotdError | None = None
        self._is_served = False
        """Once it was greeted; while it is not, whether anybody is there is found out sooner."""
        self._bytes_came = asyncio.Event()
        self._message_came = asyncio.Event()

    async def __aenter__(self) -> Self:
        # The wire outlives the line: half a message of the line before must not swallow the first of this one.
        self._wire.reset()
        self._reader = asyncio.create_task(self._read(), name=f"{self._device} reader")
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await ended((self._reader,))  # what it raised is known already, or of no interest any more
        self._lose(TransportError(f"{self._device}: the session is over"))

    @property
    def heard_ns(self) -> int:
        """When the last byte came."""
        return self._heard_ns

    async def ask(
        self,
        data: bytes,
        settles: Callable[[M], bool],
        *,
        timeout_s: float,
        tries: int = 1,
        despite_stops: bool = False,
        late_s: float = SILENCE_S,
    ) -> Heard[M]:
        """Send a request and return the message that settles it.

        Args:
            data: the request.
            settles: whether a message is its answer, a refusal included.
            timeout_s: how long a try may stay without it.
            tries: how often the request is sent at least; 1 for whatever must not happen twice.
            despite_stops: a stop does not concern it: it asks, and moves nothing.
            late_s: a request that may be repeated is, once the device is served, until its answer is so late; 0 for
                what has a time of its own.

        Raises:
            LinkTimeout: no answer to any try.
            DeviceError: a stop came between, code ``stopped``.
            TransportError: the line is lost, or was lost meanwhile.
        """
        # Before the lock: a stop that comes while this waits for its turn ends it, too.
        stops = self._stops
        async with self._one_at_a_time:
            tries = self._enough(tries, timeout_s, late_s)
            for attempt in range(tries):
                await self._settle_down()
                self._check(self._stops if despite_stops else stops)  # against itself: no stop concerns it
                self._counters.retries += attempt > 0
                request = self._request = _Request(settles, despite_stops)
                # Reckoned from the deadline: a replay fires the timer later, and must wait for quiet no longer.
                given_up_ns = now_ns() + round(timeout_s * NS_PER_S)
                try:
                    self._line.write(data)
                    async with within(timeout_s, of=f"{self._device} answer"):
                        return await request.answer
                except TimeoutError:
                    self._unsettled_ns = given_up_ns
                except asyncio.CancelledError:
                    self._unsettled_ns = now_ns()  # nobody waits for the answer now, but it may still come
                    raise
                finally:
                    self._request = None
            self._counters.timeouts += 1
            raise LinkTimeout(f"{self._device}: no answer to {data!r} in {tries * timeout_s:g} s")

    def post(self, data: bytes) -> None:
        """Send what is not answered; TransportError when the line is lost, or stuck."""
        self._check(self._stops)
        self._line.write(data)

    def stop_now(self, data: bytes) -> None:
        """Put the stop on the wire in place of everything not yet written, and give up the order under way.

        Never raises.
        """
        self._stops += 1
        self._unsettled_ns = now_ns()
        request = self._request
        if request is not None and not request.despite_stops and not request.answer.done():
            request.answer.set_exception(self._stopped())
        try:
            self._line.write_urgent(data)
        except TransportError:
            return  # it is for the device's own watchdog now, if it has one

    def stop_past_loop(self, data: bytes) -> None:
        """Put the stop on the wire from any thread, while the loop is stuck; never raises."""
        self._line.write_past_loop(data)

    def _enough(self, tries: int, timeout_s: float, late_s: float) -> int:
        """Return how often to send what may be repeated.

        By count, not by the clock: a replay, whose timers fire late, sends as many.
        """
        if tries == 1 or not self._is_served:
            return tries
        return max(tries, 1 + math.ceil(late_s / timeout_s)) if late_s > 0.0 else tries

    async def until_lost(self, silence_s: float | None = None) -> NoReturn:
        """Wait until the line is lost, or nothing that is understood came for so long; raise why.

        Raises:
            TransportError: the line is lost.
            LinkTimeout: no message came for ``silence_s``: noise is no sign of life.
        """
        self._is_served = True
        while not self._reader.done():
            if silence_s is None:
                await asyncio.wait({self._reader})
                break
            self._message_came.clear()
            try:
                async with within(silence_s, of=f"{self._device} line"):
                    came = asyncio.create_task(self._message_came.wait())
                    try:
                        await asyncio.wait({came, self._reader}, return_when=asyncio.FIRST_COMPLETED)
                    finally:
                        came.cancel()
            except TimeoutError:
                raise self._lose(LinkTimeout(f"{self._device}: silent for {silence_s:g} s")) from None
        self._reader.result()
        raise AssertionError("the reader only ends with an error")

    async def until_idle(self, seconds: float) -> None:
        """Wait until nothing is being asked, and nothing was answered for so long: time to ask whether it is there.

        Bytes that answer nothing are no sign of life: a stuck line may pour them in.
        """
        while True:
            async with self._one_at_a_time:  # a request under way is not idleness
                missing_s = seconds - (now_ns() - self._answered_ns) / NS_PER_S
            if missing_s <= 0.0:
                return
            await idle(missing_s, of=f"{self._device} talk")

    async def _settle_down(self) -> None:
        """Let late answers to what was given up go by, as reports; what never falls silent is not waited for."""
        while not self._is_never_quiet:
            # A lost line brings no late answers; why it is lost is for the caller's check to say.
            if self._unsettled_ns is None or self._lost is not None:
                return
            missing_s = self._quiet_s - (now_ns() - max(self._unsettled_ns, self._heard_ns)) / NS_PER_S
            if missing_s <= 0.0:
                break
            self._bytes_came.clear()
            with contextlib.suppress(TimeoutError):
                async with within(missing_s, of=f"{self._device} quiet"):
                    await self._bytes_came.wait()
        self._unsettled_ns = None

    @property
    def _is_never_quiet(self) -> bool:
        """Whether this many pieces came since something was given up that there is no waiting for an end.

        Counted by their times: a replay may find out later than the living loop that something was given up.
        """
        pieces_ns, since_ns = self._pieces_ns, self._unsettled_ns
        return since_ns is not None and len(pieces_ns) == _PIECES_MAX and pieces_ns[0] > since_ns

    async def _read(self) -> NoReturn:
        try:
            while True:
                chunk = await self._line.read()
                self._heard_ns = chunk.time_ns
                self._pieces_ns.append(chunk.time_ns)
                self._bytes_came.set()
                for message in self._wire.feed(chunk.data):
                    self._message_came.set()
                    self._take(Heard(message, chunk.time_ns))
        except RobotdError as error:
            raise self._lose(error) from error.__cause__
        except Exception as error:
            self._lose(TransportError(f"{self._device}: cannot go on reading: {error!r}"))
            raise  # a mistake of ours: nobody may wait for answers that are not read any more

    def _take(self, heard: Heard[M]) -> None:
        request = self._request
        if request is not None and not request.answer.done() and request.settles(heard.message):
            self._answered_ns = heard.time_ns
            request.answer.set_result(heard)
            return
        self._on_report(heard)

    def _check(self, stops: int) -> None:
        if self._lost is not None:
            raise TransportError(str(self._lost))
        if self._stops != stops:
            raise self._stopped()

    def _stopped(self) -> DeviceError:
        return DeviceError(self._device, "stopped", "before it answered")

    def _lose(self, error: RobotdError) -> RobotdError:
        # The first reason is the cause; what follows, a closed line or an ended session, only comes of it.
        if self._lost is None:
            self._lost = error
        if self._request is not None and not self._request.answer.done():
            self._request.answer.set_exception(TransportError(str(self._lost)))
        self._bytes_came.set()
        return error
