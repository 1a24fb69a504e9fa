"""A client's side of requests, without sockets and without a clock of its own.

Both clients do the same with it: send what is :meth:`Exchange.due`, hand every frame that arrives to
:meth:`Exchanges.accept`, and wait no longer than :meth:`Exchange.wait_s`. A repeat carries the number of the request
it repeats, so the server carries it out once.
"""

from typing import Any, Generic, TypeVar

from robotd.contract.envelope import Reply, decode_reply, encode_request
from robotd.contract.plain import from_plain
from robotd.contract.request import Request
from robotd.core.errors import RemoteProtocolError, RequestTimeout, ServerError

R = TypeVar("R")

UNREACHED_S = 3.0
"""So long a request waits for a daemon to connect to. One that is connected and does not answer is slow until the
request's own time is over: what nobody else does for a busy machine, its clients must not undo."""


class Exchange(Generic[R]):
    """One request and its answer."""

    def __init__(
        self,
        request_id: int,
        request: Request[R],
        *,
        client: str,
        whom: str,
        now_s: float,
        retry_s: float,
        deadline_s: float,
        unreached_s: float,
    ) -> None:
        self.id = request_id
        self._request = request
        self._whom = whom
        # Encoded once: a repeat must be the same to the last bit, or it would not be known as one.
        self._data = encode_request(request_id, request, client)
        self._retry_s = retry_s
        self._deadline_s = now_s + deadline_s
        self._next_s = now_s
        self._unreached_s = unreached_s
        self._unreached_since_s: float | None = now_s
        self._reply: Reply | None = None

    @property
    def is_answered(self) -> bool:
        """Whether the answer is there."""
        return self._reply is not None

    def due(self, now_s: float) -> bytes | None:
        """Return the request if it is time to send it, for the first time or again.

        Raises:
            RequestTimeout: there was no answer before the deadline, or nobody to ask.
        """
        if now_s >= self._ends_s:
            raise RequestTimeout(f"{self._request.cmd}: no answer from {self._whom}")
        if now_s < self._next_s:
            return None
        self._next_s = now_s + self._retry_s
        return self._data

    def reached(self) -> None:
        """Note that there was somebody to send it to."""
        self._unreached_since_s = None

    def unreached(self, now_s: float) -> None:
        """Note that there was nobody."""
        if self._unreached_since_s is None:
            self._unreached_since_s = now_s

    def wait_s(self, now_s: float) -> float:
        """Return how long to wait for a frame at most."""
        return max(0.0, min(self._next_s, self._ends_s) - now_s)

    @property
    def _ends_s(self) -> float:
        if self._unreached_since_s is None:
            return self._deadline_s
        return min(self._deadline_s, self._unreached_since_s + self._unreached_s)

    def answer(self, reply: Reply) -> None:
        """Take the answer."""
        self._reply = reply

    def result(self) -> R:
        """Return what was asked for.

        Raises:
            ServerError: the server refused.
            RemoteProtocolError: the answer is not what the request promises.
        """
        if self._reply is None:
            raise RuntimeError("not answered yet")
        if isinstance(self._reply.result, ServerError):
            raise self._reply.result
        try:
            result: R = from_plain(self._request.result, self._reply.result)
        except ValueError as error:
            raise RemoteProtocolError(f"answer to {self._request.cmd}: {error}") from error
        return result


class Exchanges:
    """The requests of one client, by number."""

    def __init__(self, whom: str, name: str = "", *, retry_s: float, deadline_s: float | None) -> None:
        """Ask ``whom``, as complaints shall call it; ``name`` is what the client calls itself, if anything."""
        self._whom = whom
        self._name = name
        self._retry_s = retry_s
        self._deadline_s = deadline_s
        self._number = 0
        self._open: dict[int, Exchange[Any]] = {}

    def begin(self, request: Request[R], now_s: float, client: str | None = None) -> Exchange[R]:
        """Open an exchange; ``client`` is another name than the usual, of somebody who is asked for."""
        self._number += 1
        given_s = self._deadline_s
        exchange = Exchange(
            self._number,
            request,
            client=self._name if client is None else client,
            whom=self._whom,
            now_s=now_s,
            retry_s=self._retry_s,
            deadline_s=request.deadline_s if given_s is None else given_s,
            unreached_s=UNREACHED_S if given_s is None else given_s,
        )
        self._open[exchange.id] = exchange
        return exchange

    def accept(self, frame: bytes) -> Exchange[Any] | None:
        """Take a frame and return the exchange it answers; None for the answer to a repeat, or to nobody.

        Raises:
            RemoteProtocolError: the frame is no reply.
            ServerError: the server could not read one of our requests, and so cannot say which.
        """
        reply = decode_reply(frame)
        if reply.id is None and isinstance(reply.result, ServerError):
            raise reply.result
        exchange = self._open.get(reply.id) if reply.id is not None else None
        if exchange is not None:
            exchange.answer(reply)
        return exchange

    def end(self, exchange: Exchange[Any]) -> None:
        """Close an exchange, answered or not."""
        self._open.pop(exchange.id, None)
