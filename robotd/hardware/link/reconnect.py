"""Keeping a link up: connect, shake hands, serve until lost, wait, again. It never arms anything."""

import asyncio
import random
from dataclasses import dataclass
from typing import NoReturn, Protocol

from firmware_proto.schema import Message
from robotd.core.errors import RobotdError
from robotd.hardware.link.handshake import Terms, shake_hands
from robotd.hardware.link.session import LinkCounters, Session
from robotd.hardware.link.tap import Tap
from robotd.hardware.link.tapped import TappedLine
from robotd.hardware.transport.transport import Connect
from robotd.hardware.wire.board import BoardWire

BACKOFF_MIN_S = 0.25
BACKOFF_MAX_S = 5.0
SILENCE_S = 1.0


class LinkListener(Protocol):
    """The device that lives at the end of a link."""

    def link_opened(self) -> None:
        """Note that the line is open; who is there is still to be seen."""

    def link_ready(self, session: Session) -> None:
        """Note that there is a board to talk to, disarmed."""

    def link_lost(self, reason: str) -> None:
        """Note that there is none, or none any more, and why."""

    def telemetry(self, message: Message) -> None:
        """Take a message that nobody asked for."""


@dataclass(frozen=True, slots=True)
class Link:
    """What it takes to reach one board, again and again."""

    device: str
    terms: Terms
    connect: Connect
    tap: Tap
    rng: random.Random
    """Where nonces come from."""
    dictionaries: dict[int, bytes]
    """Dictionaries read so far, by CRC-32."""
    wire: BoardWire
    counters: LinkCounters

    async def run(self, listener: LinkListener) -> NoReturn:
        """Keep the link up until cancelled; nothing that a board or a line does ends it."""
        backoff_s = BACKOFF_MIN_S
        while True:
            sessions = self.counters.sessions
            try:
                await self._serve_once(listener)
            except RobotdError as error:
                listener.link_lost(str(error))
            except asyncio.CancelledError:
                listener.link_lost("shut down")
                raise
            if self.counters.sessions > sessions:
                backoff_s = BACKOFF_MIN_S
            await asyncio.sleep(backoff_s)
            backoff_s = min(2 * backoff_s, BACKOFF_MAX_S)

    async def _serve_once(self, listener: LinkListener) -> NoReturn:
        line = TappedLine(self.device, await self.connect(), self.tap)
        try:
            listener.link_opened()
            session = Session(
                self.device,
                line,
                self.wire,
                counters=self.counters,
                on_telemetry=listener.telemetry,
                silence_s=SILENCE_S,
            )
            async with session:
                try:
                    await shake_hands(session, self.terms, self.rng.getrandbits(32), self.dictionaries)
                    self.counters.sessions += 1
                    listener.link_ready(session)
                    await session.serve()
                finally:
                    session.stop_now()  # whatever ended it, nothing must go on moving
        finally:
            line.close()
