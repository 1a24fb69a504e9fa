"""How often and how many: wrong tokens of an address, connections of a session and in all, messages of a browser."""

from collections import Counter, OrderedDict, deque

from robotd.core.errors import ServerError

WRONG_TOKENS = 5
"""An address may try in ``WINDOW_S``; then it is refused, right token or wrong."""
WINDOW_S = 60.0
MOST_ADDRESSES = 4096
"""That are remembered; who can come from more addresses than that has no need to guess."""
CONNECTIONS = 256
CONNECTIONS_OF_SESSION = 32


class WrongTokens:
    """Who tried wrong tokens of late."""

    def __init__(self) -> None:
        self._tries: OrderedDict[str, deque[float]] = OrderedDict()

    def refuse(self, address: str, now_s: float) -> None:
        """Return if an address may try.

        Raises:
            ServerError: it tried too often; says when it may again.
        """
        tries = self._recent(address, now_s)
        if len(tries) >= WRONG_TOKENS:
            left_s = tries[0] + WINDOW_S - now_s
            raise ServerError("too_many_tries", f"too many wrong tokens from {address}: wait {left_s:.0f} s")

    def note(self, address: str, now_s: float) -> None:
        """Count a wrong token against an address, for :data:`WINDOW_S`."""
        tries = self._recent(address, now_s)
        tries.append(now_s)
        self._tries[address] = tries
        # The one that tried the longest ago is forgotten first; who goes on trying is not.
        self._tries.move_to_end(address)
        while len(self._tries) > MOST_ADDRESSES:
            self._tries.popitem(last=False)

    def _recent(self, address: str, now_s: float) -> deque[float]:
        tries = self._tries.get(address, deque())
        while tries and now_s - tries[0] >= WINDOW_S:
            tries.popleft()
        return tries


class Crowd:
    """Who is connected."""

    def __init__(self, most: int = CONNECTIONS, most_of_session: int = CONNECTIONS_OF_SESSION) -> None:
        self._most, self._most_of_session = most, most_of_session
        self._of: Counter[str] = Counter()

    def enter(self, session: str) -> None:
        """Count one more.

        Raises:
            ServerError: there is no room.
        """
        if self.total >= self._most:
            raise ServerError("full", f"{self._most} connections are open: close one")
        if self._of[session] >= self._most_of_session:
            raise ServerError("full", f"this session has {self._most_of_session} connections open: close one")
        self._of[session] += 1

    def leave(self, session: str) -> None:
        """Count one less."""
        self._of[session] -= 1
        if not self._of[session]:
            del self._of[session]

    @property
    def total(self) -> int:
        """How many there are."""
        return self._of.total()


class Rate:
    """At most this many a second, and as many at once."""

    def __init__(self, per_s: float, now_s: float) -> None:
        self._per_s = per_s
        self._left = per_s
        self._at_s = now_s

    def take(self, now_s: float) -> bool:
        """Return whether one more is within bounds, and count it."""
        self._left = min(self._per_s, self._left + (now_s - self._at_s) * self._per_s)
        self._at_s = now_s
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True
