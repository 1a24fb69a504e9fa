"""Requests to the daemon, each sent once and at once, or not at all.

Clients of robotd repeat what is not answered. A gateway must not: a repeat may reach another daemon than the one that
was meant, which has just started, and a press on a button of a minute ago must not move a robot now.
"""

import asyncio
import math
from types import TracebackType
from typing import Any, Protocol, Self, TypeVar

import zmq
import zmq.asyncio

from robotd.client.exchange import Exchanges
from robotd.client.sockets import connect_dealer
from robotd.contract.request import Request
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.endpoints import Endpoints
from robotd.core.errors import RequestTimeout, RobotdError, ServerError
from robotd.core.together import ended

R = TypeVar("R")

NAME = "robotd-gateway"
"""What the daemon knows us by."""
NOBODY = "no_daemon"
UNKNOWN = "outcome_unknown"


class Asks(Protocol):
    """Anyone who sends a request once."""

    async def ask(self, request: Request[R], within_s: float | None = None, who: str | None = None) -> R:
        """Send a request and return its answer; :meth:`Asker.ask` says more."""


class Asker:
    """One DEALER; any number of requests at a time."""

    def __init__(self, context: zmq.asyncio.Context, endpoints: Endpoints) -> None:
        self._endpoints = endpoints
        self._context = context
        # Never again: with an endless pause between two tries the client's own bookkeeping sends each request
        # once.
        self._exchanges = Exchanges(str(endpoints), NAME, retry_s=math.inf, deadline_s=None)
        self._waiting: dict[int, asyncio.Future[None]] = {}

    async def __aenter__(self) -> Self:
        """Connect; the daemon need not run yet."""
        self._socket = self._context.socket(zmq.DEALER)
        connect_dealer(self._socket, self._endpoints, retry_s=1.0)
        self._reader = asyncio.create_task(self._read(), name="answers of the daemon")
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None
    ) -> None:
        # Before the socket is closed, which it reads from.
        await ended([self._reader])
        self._socket.close(0)

    async def ask(self, request: Request[R], within_s: float | None = None, who: str | None = None) -> R:
        """Send a request, for ``who`` if that is somebody, and return its answer.

        It is waited for as long as the request's own time, or ``within_s`` instead.

        Raises:
            ServerError: the daemon refused; or nobody is there and nothing was sent (``no_daemon``); or no answer came,
                and it is not known whether it was carried out (``outcome_unknown``).
            RemoteProtocolError: the answer is not what the request promises.
        """
        exchange = self._exchanges.begin(request, _now_s(), who)
        answered = self._waiting[exchange.id] = asyncio.get_running_loop().create_future()
        data = exchange.due(_now_s())
        try:
            # Not waited for: what cannot leave at once would lie in a queue, and reach a daemon that starts
            # later.
            await self._socket.send(data, zmq.DONTWAIT)
            exchange.reached()
            async with asyncio.timeout(exchange.wait_s(_now_s()) if within_s is None else within_s):
                await answered
            return exchange.result()
        except zmq.Again:
            raise ServerError(
                NOBODY, f"{request.cmd}: nothing was sent: no daemon answers in {self._endpoints}"
            ) from None
        except (TimeoutError, RequestTimeout):
            raise ServerError(UNKNOWN, f"{request.cmd}: no answer; look whether it was carried out") from None
        finally:
            self._exchanges.end(exchange)
            del self._waiting[exchange.id]

    async def _read(self) -> None:
        while True:
            frame = await self._socket.recv()
            try:
                exchange = self._exchanges.accept(frame)
            except RobotdError as error:  # nobody can say whose answer this was
                for waiting in self._waiting.values():
                    if not waiting.done():
                        waiting.set_exception(error)
            else:
                self._settle(exchange)

    def _settle(self, exchange: Any) -> None:
        waiting = None if exchange is None else self._waiting.get(exchange.id)
        if waiting is not None and not waiting.done():
            waiting.set_result(None)


def _now_s() -> float:
    return now_ns() / NS_PER_S
