"""How often a client may ask, and all of them together: buckets, each filled at a steady rate.

Who asks seldom is served whatever the others do: only what a client asks beyond that comes out of the common bucket.
"""

import enum
from collections import OrderedDict

from robotd.core.clock import NS_PER_S, now_ns

PER_CLIENT_HZ = 200.0
"""Of one client, renewals included."""
ALTOGETHER_HZ = 200.0
"""Of what all clients ask but stops and renewals: what carries it out has more to do than that."""
_SELDOM_HZ = 2.0
"""A client that asks no more often asks seldom."""
_BURST_S = 0.5
_SELDOM_BURST_S = 3.0
"""A quiet while saves up this much."""
_REMEMBERED = 1024
"""Clients; one that is forgotten begins with full buckets."""


class Often(enum.Enum):
    """How often a client asks."""

    SELDOM = enum.auto()
    OFTEN = enum.auto()
    TOO_OFTEN = enum.auto()
    """It has to wait; nothing is carried out."""


class Bucket:
    """Gives what it was filled with."""

    def __init__(self, rate_hz: float, burst_s: float) -> None:
        self._rate_hz = rate_hz
        self._most = rate_hz * burst_s
        self._saved = self._most
        self._looked_ns = now_ns()

    def take(self) -> bool:
        """Take one, if there is one."""
        at_ns = now_ns()
        self._saved = min(self._most, self._saved + (at_ns - self._looked_ns) / NS_PER_S * self._rate_hz)
        self._looked_ns = at_ns
        if self._saved < 1.0:
            return False
        self._saved -= 1.0
        return True


class Rates:
    """Says whether a client may ask now."""

    def __init__(self) -> None:
        self._clients: OrderedDict[bytes, tuple[Bucket, Bucket]] = OrderedDict()
        """Of each, what it asks, and what it asks seldom."""
        self._all = Bucket(ALTOGETHER_HZ, _BURST_S)

    def asked(self, identity: bytes, *, only_its_own: bool) -> Often:
        """Count a request, and say how often this client asks; ``only_its_own`` takes nothing of the common bucket."""
        own, seldom = self._clients.pop(identity) if identity in self._clients else _buckets()
        self._clients[identity] = own, seldom
        if len(self._clients) > _REMEMBERED:
            self._clients.popitem(last=False)
        if not own.take():
            return Often.TOO_OFTEN
        # Renewals are bounded by their own client alone: a mission must not end because others ask much.
        if only_its_own:
            return Often.OFTEN
        if seldom.take():
            return Often.SELDOM
        return Often.OFTEN if self._all.take() else Often.TOO_OFTEN


def _buckets() -> tuple[Bucket, Bucket]:
    return Bucket(PER_CLIENT_HZ, _BURST_S), Bucket(_SELDOM_HZ, _SELDOM_BURST_S)
