"""What the adapters of our own three boards share: the link, health, arming."""

from typing import ClassVar

from firmware_proto.common import Arm, BoardKind, BoardState, BoardStatus, Clear, Fault
from firmware_proto.schema import Message
from robotd.contract.device_status import LinkState
from robotd.core.attention import attention
from robotd.core.errors import DeviceError, TransportError
from robotd.hardware.devices.credible import IMPLAUSIBLE, Times
from robotd.hardware.devices.device import PAST_LOOP_EVERY
from robotd.hardware.devices.health import Health
from robotd.hardware.devices.rest import Rest
from robotd.hardware.devices.settings import BoardOptions
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.devices.with_health import WithHealth
from robotd.hardware.link.handshake import Terms
from robotd.hardware.link.reconnect import Link
from robotd.hardware.link.session import LinkCounters, Session
from robotd.hardware.wire.board import BoardWire

_FAULT_BITS = 16
"""Width of the field: a bit that has no name yet is a fault, too (PROTOCOL.md)."""


class BoardDevice(WithHealth):
    """One of our boards, as a device: a subclass adds what it measures and what it moves."""

    KIND: ClassVar[BoardKind]
    REPORTED: ClassVar[frozenset[str]] = frozenset({"armed"})
    """What its telemetry tells that is over when it rests."""

    def __init__(self, settings: BoardOptions, wiring: Wiring) -> None:
        """Make the device; nothing happens before :meth:`run`."""
        self._wire = BoardWire(self.KIND)
        self._counters = LinkCounters()
        self._session: Session | None = None
        self._may_move = False
        """Whether an arm was asked for, and no stop since."""
        self._is_distrusted = False
        """Whether it said what cannot be, and nobody has cleared that."""
        self._silence_s = settings.silence_s
        self._times = Times(self.name, self._silence_s)
        self._rest = Rest()
        self._health = Health(self.name, self._counted)
        self._link = Link(
            device=self.name,
            terms=Terms(self.KIND, settings.telemetry_ms, settings.ttl_max_ms),
            connect=wiring.connect,
            tap=wiring.tap,
            rng=wiring.rng,
            dictionaries={},
            wire=self._wire,
            counters=self._counters,
            silence_s=self._silence_s,
        )

    @property
    def name(self) -> str:
        """``drive``, ``pantilt`` or ``rangefinder``."""
        return self.KIND.name.lower()

    async def run(self) -> None:
        """Own the link until cancelled: connect, serve, reconnect with back-off, never arm by itself."""
        await self._link.run(self)

    async def arm(self) -> None:
        """Allow motion; see :meth:`robotd.hardware.devices.device.Device.arm`."""
        if self._health.faults:
            raise DeviceError(self.name, "fault", f"{', '.join(self._health.faults)} latched: clear first")
        # Before it is asked: a status that says armed may be read before the answer, and must not be stopped for it.
        self._may_move = True
        await self._order(Arm())
        self._health.change(armed=True)

    async def clear_faults(self) -> None:
        """Acknowledge latched faults; leaves the device disarmed; same errors as :meth:`arm`."""
        await self._order(Clear())
        self._is_distrusted = False
        self._health.change(armed=False, faults=(), detail="")

    def stop_now(self) -> None:
        """Put the preformatted stop on the wire in place of all that waits; never blocks, never raises.

        A stop can be lost like any frame, so it is said again each time the board says that it is still armed.
        """
        self._may_move = False
        if self._session is not None:
            self._session.stop_now()

    def stop_past_loop(self, before: int = 0) -> None:
        """Put the stop on the wire from any thread, while the loop is stuck; see :class:`.Device`."""
        self._may_move = False
        session = self._session
        if session is not None and before % PAST_LOOP_EVERY == 0:
            session.stop_past_loop()

    # What the link tells

    def link_opened(self) -> None:
        """Note that the line is open."""
        self._is_distrusted = False
        self._times = Times(self.name, self._silence_s)
        self._health.change(
            link=LinkState.CONNECTING, armed=False, faults=(), detail="line open, waiting for the board"
        )

    def link_ready(self, session: Session) -> None:
        """Note that there is a board to talk to."""
        self._session = session
        self._health.change(link=LinkState.READY, armed=False, detail="")

    def link_lost(self, reason: str) -> None:
        """Note that there is none, and why."""
        self._session = None
        self._may_move = False
        # The board keeps what it has latched through a new session, and reports it again.
        self._health.change(link=LinkState.ABSENT, armed=False, faults=(), detail=reason)

    def telemetry(self, message: Message) -> None:
        """Take a message that nobody asked for; a subclass takes its own first."""
        if isinstance(message, BoardStatus):
            is_armed = message.state == BoardState.ARMED
            self._rest.told("armed", goes_on=is_armed)
            if is_armed and not self._may_move:
                self.stop_now()
            # A status replaces all faults, and the board knows nothing of the one that is ours.
            ours = (IMPLAUSIBLE,) if self._is_distrusted else ()
            self._health.change(armed=is_armed, faults=(*fault_names(message.faults), *ours))

    async def come_to_rest(self) -> None:
        """Return once the board reported, since this was asked, that it is not armed and moves nothing."""
        if self._session is not None:  # else there was no board yet that could have been armed
            await self._rest.seen(self.REPORTED)

    # What a subclass uses

    def _talk(self) -> Session:
        """Return the session; TransportError if there is none."""
        if self._session is None:
            raise TransportError(f"{self.name} is absent: {self._health.detail}")
        return self._session

    async def _order(self, message: Message) -> None:
        session = self._talk()
        await session.command(message)
        # The line was lost and is back: what was answered is void, for the new session begins disarmed.
        if self._session is not session:
            raise TransportError(f"{self.name} was lost: {self._health.detail}")

    def _distrust(self, error: DeviceError) -> None:
        """Stop, count, and latch that it said what cannot be."""
        self._counters.implausible += 1
        self.stop_now()
        self._is_distrusted = True
        if IMPLAUSIBLE not in self._health.faults:  # a liar lies with every message; one is news
            self._health.change(armed=False, faults=(*self._health.faults, IMPLAUSIBLE), detail=str(error))

    def _host_ns(self, board_us: int, *, periodic: bool = False) -> int:
        """Return the host's time at a time of the board; DeviceError if it cannot be."""
        session = self._talk()
        # Judged on the bare fit: host_ns remembers what it is asked for, and would carry a lie on to later times.
        time_ns = session.heard_ns + session.clock.ahead_ns(board_us, session.heard_ns)
        if periodic:
            self._times.check_periodic(time_ns, session.heard_ns, attention().missed_s)
        else:
            self._times.check(time_ns, session.heard_ns)
        return session.clock.host_ns(board_us)

    def _counted(self) -> tuple[tuple[str, int], ...]:
        wire, link = self._wire.counters, self._counters
        return (
            ("frames", wire.frames),
            ("crc_errors", wire.crc_errors),
            ("cobs_errors", wire.cobs_errors),
            ("length_errors", wire.length_errors),
            ("unknown_types", wire.unknown_types),
            ("telemetry_gaps", wire.telemetry_gaps),
            ("sessions", link.sessions),
            ("retries", link.retries),
            ("timeouts", link.timeouts),
            ("refused", link.refused),
            ("unmatched", link.unmatched),
            ("implausible", link.implausible + self._unlikely()),
            *self._clock(),
        )

    def _clock(self) -> tuple[tuple[str, int], ...]:
        """Return how much faster the board's clock runs than ours, and how well that is known."""
        best = None if self._session is None else self._session.clock.best
        if best is None:
            return ()
        return (("clock_fast_ppb", round((1.0 / best.rate - 1.0) * 1e9)), ("clock_round_trip_us", best.round_trip_us))


def fault_names(faults: int) -> tuple[str, ...]:
    """Return the names of latched faults in lower case; a bit that we do not know is named by its number.

    >>> fault_names(1 | 2 | 1 << 9)
    ('deadman', 'bumper', 'fault_9')
    """
    names = {fault.value: (fault.name or "").lower() for fault in Fault}
    return tuple(names.get(1 << bit, f"fault_{bit}") for bit in range(_FAULT_BITS) if faults & 1 << bit)
