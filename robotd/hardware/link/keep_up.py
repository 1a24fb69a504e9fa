"""Keeping a line up: connect, talk until it is lost, wait, again. It never arms anything."""

import asyncio
from collections.abc import Awaitable
from typing import NoReturn, Protocol

from robotd.core.errors import RobotdError
from robotd.hardware.link.tap import Tap
from robotd.hardware.link.tapped import TappedLine
from robotd.hardware.transport.transport import Connect

BACKOFF_MIN_S = 0.25
BACKOFF_MAX_S = 5.0
"""A device that is plugged in again is found within this, however long it was gone."""


class Talker(Protocol):
    """Who uses the line."""

    @property
    def sessions(self) -> int:
        """How often the right device was found at the other end; the back-off begins again with each."""

    def talk(self, line: TappedLine) -> Awaitable[NoReturn]:
        """Talk until the line is lost; raise why. The line is closed by the caller."""

    def line_lost(self, reason: str) -> None:
        """Note that there is no line, and why."""


async def keep_up(device: str, connect: Connect, tap: Tap, talker: Talker) -> NoReturn:
    """Keep a line up until cancelled; nothing that a device, a line or the operating system does ends it.

    Args:
        device: what the tap calls the line.
        connect: opens it; a name under ``/dev`` is resolved again each time.
        tap: sees every byte.
        talker: who uses it.
    """
    backoff_s = BACKOFF_MIN_S
    while True:
        sessions = talker.sessions
        try:
            # Tapped from its first byte: what a board says as the port is opened belongs to the recording.
            line = TappedLine(device, await connect(), tap)
            try:
                await talker.talk(line)
            finally:
                line.close()
        except (RobotdError, OSError) as error:  # any other is ours, and ends the daemon, stop first
            talker.line_lost(str(error))
        except asyncio.CancelledError:
            talker.line_lost("shut down")
            raise
        # An open port does not count, only the right device behind it: a stranger is not asked four times a second.
        if talker.sessions > sessions:
            backoff_s = BACKOFF_MIN_S
        await asyncio.sleep(backoff_s)
        backoff_s = min(2 * backoff_s, BACKOFF_MAX_S)
