"""Sessions: who signed in, known by a secret in a cookie, of which only the hash is kept.

A session ends by signing out, by idleness, with its token, or when there are too many. One that ended within a day may
still stop the robot. Times are Unix times, so that sessions outlive the gateway; a clock that is set back ends none.
"""

import secrets

import msgspec

from robotd.gateway.access.roles import Role
from robotd.gateway.access.tokens import Token, Tokens, hashed

_BYTES = 32
MOST = 1000
"""Sessions kept, ended ones among them: beyond, the one that was seen last the longest ago is forgotten."""
MAY_STILL_STOP_S = 24 * 3600.0


class ConsoleSession(msgspec.Struct, forbid_unknown_fields=True):
    """Somebody who signed in."""

    sha256: str
    """Of the secret in the cookie; names the session wherever it has to be named."""
    token: str
    """Name of the token that began it."""
    token_made_unix_s: int
    """Tells a token from a later one of the same name."""
    role: Role
    begun_unix_s: float
    seen_unix_s: float
    ended_unix_s: float | None = None


class Sessions:
    """All sessions, ended ones for as long as they may still stop."""

    def __init__(self, idle_s: float) -> None:
        self._idle_s = idle_s
        self._by_hash: dict[str, ConsoleSession] = {}

    def begin(self, token: Token, now_unix_s: float) -> tuple[str, ConsoleSession]:
        """Return the secret of a new session, and the session."""
        secret = secrets.token_urlsafe(_BYTES)
        session = ConsoleSession(hashed(secret), token.name, token.made_unix_s, token.role, now_unix_s, now_unix_s)
        self._by_hash[session.sha256] = session
        if len(self._by_hash) > MOST:
            del self._by_hash[min(self._by_hash.values(), key=lambda one: one.seen_unix_s).sha256]
        return secret, session

    def find(self, secret: str, now_unix_s: float) -> ConsoleSession | None:
        """Return the session of a secret if it stands, and note that it was seen."""
        session = self._by_hash.get(hashed(secret))
        if session is None or not self.stands(session, now_unix_s):
            return None
        # The later one: a clock that was set back must not end the sessions of all who look on.
        session.seen_unix_s = max(session.seen_unix_s, now_unix_s)
        return session

    def may_stop(self, secret: str, now_unix_s: float) -> ConsoleSession | None:
        """Return the session of a secret if it stands, or stood within a day."""
        session = self._by_hash.get(hashed(secret))
        if session is None or self.stands(session, now_unix_s):
            return session
        ended = session.ended_unix_s if session.ended_unix_s is not None else session.seen_unix_s + self._idle_s
        return session if now_unix_s - ended < MAY_STILL_STOP_S else None

    def stands(self, session: ConsoleSession, now_unix_s: float) -> bool:
        """Return whether a session neither ended nor idled too long."""
        return session.ended_unix_s is None and now_unix_s - session.seen_unix_s < self._idle_s

    def end(self, session: ConsoleSession, now_unix_s: float) -> None:
        """End a session, unless it has ended; it may still stop the robot for a day."""
        if session.ended_unix_s is None:
            session.ended_unix_s = now_unix_s

    def end_revoked(self, tokens: Tokens, now_unix_s: float) -> list[ConsoleSession]:
        """End the sessions of which the token is gone or over, and return those that stood."""
        standing = [one for one in self.all if self.stands(one, now_unix_s) and not _has_token(one, tokens, now_unix_s)]
        for session in standing:
            self.end(session, now_unix_s)
        return standing

    @property
    def all(self) -> list[ConsoleSession]:
        """All of them, the latest first."""
        return sorted(self._by_hash.values(), key=lambda one: -one.begun_unix_s)

    def to_bytes(self, now_unix_s: float) -> bytes:
        """Return what to keep over a restart."""
        kept = [one for one in self.all if now_unix_s - one.seen_unix_s < self._idle_s + MAY_STILL_STOP_S]
        return msgspec.json.encode(kept)

    def take(self, data: bytes) -> None:
        """Take what was kept; nothing, if it cannot be read: then everybody signs in again."""
        try:
            kept = msgspec.json.decode(data, type=list[ConsoleSession])
        except msgspec.DecodeError:
            return
        self._by_hash = {session.sha256: session for session in kept[:MOST]}


def _has_token(session: ConsoleSession, tokens: Tokens, now_unix_s: float) -> bool:
    token = tokens.named(session.token)
    return token is not None and token.made_unix_s == session.token_made_unix_s and token.is_valid(now_unix_s)
