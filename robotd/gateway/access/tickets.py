"""Tickets: addresses that let one program in once, soon, as who asked for it. For programs that can bring no token."""

import secrets
from typing import Generic, TypeVar

T = TypeVar("T")

VALID_S = 120.0
_MOST = 32
_BYTES = 32


class Tickets(Generic[T]):
    """Those that stand; the oldest goes where there are too many."""

    def __init__(self) -> None:
        self._standing: dict[str, tuple[T, float]] = {}

    def issue(self, holder: T, now_s: float) -> str:
        """Return a ticket for somebody."""
        if len(self._standing) >= _MOST:
            del self._standing[next(iter(self._standing))]
        ticket = secrets.token_urlsafe(_BYTES)
        self._standing[ticket] = (holder, now_s + VALID_S)
        return ticket

    def use(self, ticket: str, now_s: float) -> T | None:
        """Return who a ticket is for, once; None if it is none any more."""
        holder, until_s = self._standing.pop(ticket, (None, 0.0))
        return holder if now_s < until_s else None
