"""A link to one of our boards: connect, shake hands, serve until lost, wait, again. It never arms anything."""

import random
from dataclasses import dataclass
from typing import NoReturn, Protocol

from firmware_proto.schema import Message
from robotd.core.errors import RobotdError
from robotd.hardware.link.handshake import Terms, shake_hands
from robotd.hardware.link.keep_up import keep_up
from robotd.hardware.link.seen_at_rest import seen_at_rest
from robotd.hardware.link.session import LinkCounters, Session
from robotd.hardware.link.tap import Tap
from robotd.hardware.link.tapped import TappedLine
from robotd.hardware.transport.transport import Connect
from robotd.hardware.wire.board import BoardWire


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

    async def come_to_rest(self) -> None:
        """Return once the board reported, since this was asked, that it is not armed and moves nothing."""


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
    silence_s: float
    """The board is lost when nothing came for so long."""

    async def run(self, listener: LinkListener) -> NoReturn:
        """Keep the link up until cancelled; nothing that a board or a line does ends it."""
        await keep_up(self.device, self.connect, self.tap, _Talk(self, listener))


@dataclass(frozen=True, slots=True)
class _Talk:
    """What is done on each line."""

    link: Link
    listener: LinkListener

    @property
    def sessions(self) -> int:
        return self.link.counters.sessions

    def line_lost(self, reason: str) -> None:
        self.listener.link_lost(reason)

    async def talk(self, line: TappedLine) -> NoReturn:
        self.listener.link_opened()
        link = self.link
        session = Session(
            link.device,
            line,
            link.wire,
            counters=link.counters,
            on_telemetry=self.listener.telemetry,
            silence_s=link.silence_s,
        )
        async with session:
            try:
                await shake_hands(session, link.terms, link.rng.getrandbits(32), link.dictionaries)
                link.counters.sessions += 1  # not sooner: the back-off begins again with it
                self.listener.link_ready(session)
                await session.serve()
            except BaseException as error:  # whatever ended it, nothing must go on moving
                session.stop_now()
                if not isinstance(error, Exception):  # else it is for the board's deadman
                    await seen_at_rest(self.listener.come_to_rest())
                elif not isinstance(error, RobotdError):  # a mistake of ours: the others are stopped now
                    self.listener.link_lost(repr(error))
                raise
