"""The replies given lately, so that a request that is sent twice is carried out once."""

from collections import OrderedDict

Asker = tuple[bytes, int]
"""The client's identity on the socket, and the number of its request."""


class Replies:
    """A bounded memory of requests under way and answered; the oldest answers give way."""

    def __init__(self, remembered: int) -> None:
        self._remembered = remembered
        self._under_way: set[Asker] = set()
        self._given: OrderedDict[Asker, bytes] = OrderedDict()

    def begin(self, asker: Asker) -> None:
        """Note that a request is being carried out."""
        self._under_way.add(asker)

    def is_under_way(self, asker: Asker) -> bool:
        """Return whether a request is being carried out; its one reply will do for all its repeats."""
        return asker in self._under_way

    def given(self, asker: Asker) -> bytes | None:
        """Return the reply a request was given, if it is remembered."""
        return self._given.get(asker)

    def end(self, asker: Asker, reply: bytes | None) -> None:
        """Note how a request ended; a reply of None is not worth remembering."""
        self._under_way.discard(asker)
        if reply is None:
            return
        self._given[asker] = reply
        if len(self._given) > self._remembered:
            self._given.popitem(last=False)
