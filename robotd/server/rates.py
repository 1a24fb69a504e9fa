"""How often a client may ask, and all of them together: a bucket each, filled at a steady rate.

Who asks seldom is served whatever the others do: only a client that has emptied half of its own bucket takes from the
common one.
"""

from collections import OrderedDict

from robotd.core.clock import NS_PER_S, now_ns

PER_CLIENT_HZ = 200.0
"""Of one client: twenty times what renewing a lease takes."""
ALTOGETHER_HZ = 1000.0
"""Of what all clients ask but stops and renewals: what carries it out has more to do than that."""
_BURST_S = 0.5
"""A quiet while saves up this much."""
_SELDOM = 0.5
"""A bucket that is filled to this share is one of a client that asks seldom."""
_REMEMBERED = 1024
"""Clients; one that is forgotten begins with a full bucket."""


class Bucket:
    """Gives what it was filled with."""

    def __init__(self, rate_hz: float) -> None:
        self._rate_hz = rate_hz
        self._saved = rate_hz * _BURST_S
        self._looked_ns = now_ns()

    @property
    def is_of_one_that_asks_seldom(self) -> bool:
        """Whether little was taken lately."""
        return self._saved >= _SELDOM * self._rate_hz * _BURST_S

    def take(self) -> bool:
        """Take one, if there is one."""
        at_ns = now_ns()
        gained = (at_ns - self._looked_ns) / NS_PER_S * self._rate_hz
        self._saved = min(self._rate_hz * _BURST_S, self._saved + gained)
        self._looked_ns = at_ns
        if self._saved < 1.0:
            return False
        self._saved -= 1.0
        return True


class Rates:
    """Says whether a client may ask now."""

    def __init__(self) -> None:
        self._clients: OrderedDict[bytes, Bucket] = OrderedDict()
        self._all = Bucket(ALTOGETHER_HZ)

    def allow(self, identity: bytes, *, only_its_own: bool) -> bool:
        """Count a request, and return whether it may be carried out; ``only_its_own`` takes nothing of all clients'."""
        bucket = self._clients.pop(identity, None) or Bucket(PER_CLIENT_HZ)
        self._clients[identity] = bucket
        if len(self._clients) > _REMEMBERED:
            self._clients.popitem(last=False)
        return bucket.take() and (only_its_own or bucket.is_of_one_that_asks_seldom or self._all.take())
