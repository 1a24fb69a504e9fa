"""What the parts of a gateway share: who may come in, what is known, and what can be done."""

import asyncio
import contextlib
import logging
from typing import Protocol

from robotd.core.clock import NS_PER_S, now_ns, wall_offset_ns
from robotd.core.errors import ConfigError
from robotd.gateway.access.sessions import ConsoleSession, Sessions
from robotd.gateway.access.tickets import Tickets
from robotd.gateway.access.tokens import Token, TokenFile, Tokens, write_private
from robotd.gateway.access.visitor_limits import Crowd, WrongTokens
from robotd.gateway.browser.page_connection import Person
from robotd.gateway.browser.services import Services
from robotd.gateway.console_files import ConsoleFiles
from robotd.gateway.feed.page_outbox import PageOutbox
from robotd.gateway.made_files import MadeFiles
from robotd.gateway.settings import GatewaySettings

NO_TOKEN = "no token: nobody could sign in; make one, with: robotctl gateway token new NAME --role operator"
_LOOK_S = 0.5
_SAVE_EVERY = 120

log = logging.getLogger(__name__)


class Connected(Protocol):
    """Somebody who is told what the robot tells."""

    person: Person
    outbox: PageOutbox
    woken: asyncio.Event
    """Set when something waits in the outbox."""
    ended: str | None
    """Why this connection has to end; None while it need not."""

    def finish(self, why: str) -> None:
        """Let the connection end as soon as it can."""


def unix_s() -> float:
    """Return the time by the calendar [s]."""
    return (now_ns() + wall_offset_ns()) / NS_PER_S


class House:
    """Everything that answering a request may need, one of each."""

    def __init__(self, settings: GatewaySettings, services: Services) -> None:
        """Read who may come in.

        Raises:
            ConfigError: nobody may.
        """
        self.settings, self.services = settings, services
        self.token_file = TokenFile(settings.access.tokens)
        self._mark = self.token_file.mark()
        self.tokens: Tokens = self.token_file.read()
        self.sessions = Sessions(settings.access.idle_h * 3600.0)
        with contextlib.suppress(OSError):
            self.sessions.take(settings.access.sessions.read_bytes())
        self.sessions.end_revoked(self.tokens, unix_s())
        if not (self.tokens.usable(unix_s()) or any(self.sessions.stands(one, unix_s()) for one in self.sessions.all)):
            raise ConfigError(NO_TOKEN)
        self.wrong_tokens = WrongTokens()
        self.crowd = Crowd()
        self.connections: set[Connected] = set()
        self.tickets: Tickets[Person] = Tickets()
        self.sign_ins = 0
        self.refused_sign_ins = 0
        self.dropped_messages = 0
        """Left out for browsers that are gone; those of the others are in their outboxes."""
        self.files = ConsoleFiles()
        self.made = MadeFiles()
        self.showing = asyncio.Lock()
        """Held while a stored map is asked for: of one client the daemon takes two such requests at a time, and a page
        of cards asks for many."""
        self.importing = asyncio.Lock()
        """Held while a map of another program is read, which takes hundreds of megabytes: one at a time has to do."""

    def match(self, secret: str) -> Token | None:
        """Return the token of a secret, by the file as it is now; one for one use is used up."""
        self.look_at_tokens()
        token = self.tokens.match(secret, unix_s())
        if token is not None and token.is_for_one_use:
            self.tokens = self.tokens.with_used(token)
            self.token_file.write(self.tokens)
            self._mark = self.token_file.mark()
        return token

    def look_at_tokens(self) -> None:
        """Read the tokens again if they changed, and end what was begun with one that is gone."""
        mark = self.token_file.mark()
        if mark != self._mark:
            try:
                self.tokens, self._mark = self.token_file.read(), mark
            except ConfigError as error:
                log.warning("%s; the tokens stay as they were", error)
        for session in self.sessions.end_revoked(self.tokens, unix_s()):
            self.drop(session)

    def drop(self, session: ConsoleSession) -> None:
        """Hang up on every page of a session that ended."""
        for connection in tuple(self.connections):
            if connection.person.session == session.sha256:
                connection.finish("the session has ended")

    def _drop_idle(self) -> None:
        """Hang up where neither a session nor a token stands any more; a page that is open keeps its session."""
        now = unix_s()
        standing = {one.sha256: one for one in self.sessions.all if self.sessions.stands(one, now)}
        tokens = {one.sha256 for one in self.tokens.all if one.is_valid(now)}
        for connection in tuple(self.connections):
            session = standing.get(connection.person.session)
            if session is not None:
                session.seen_unix_s = max(session.seen_unix_s, now)
            elif connection.person.session not in tokens:
                connection.finish("the session has ended")

    async def save_sessions(self) -> None:
        """Keep the sessions over a restart, without letting a stop wait for a disk."""
        await asyncio.to_thread(self._write_sessions, self.sessions.to_bytes(unix_s()))

    def _write_sessions(self, data: bytes) -> None:
        """Write them; a disk that refuses means that everybody signs in again."""
        try:
            write_private(self.settings.access.sessions, data)
        except OSError as error:
            log.warning("sessions could not be kept: %s", error)

    async def watch_access(self) -> None:
        """Notice revoked tokens and idle sessions: a duty."""
        looks = 0
        try:
            while True:
                await asyncio.sleep(_LOOK_S)
                self.look_at_tokens()
                self._drop_idle()
                looks += 1
                if looks % _SAVE_EVERY == 0:
                    await self.save_sessions()
        finally:
            self._write_sessions(self.sessions.to_bytes(unix_s()))
