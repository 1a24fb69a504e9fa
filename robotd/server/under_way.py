"""The requests under way, and whether there is room for one more.

Stops and renewals have room of their own each, so that what takes long cannot keep one from its answer; and no client
may take more than half of the rest.
"""

import asyncio
from typing import Any

from robotd.contract.request import Request
from robotd.contract.requests import Arm, Renew
from robotd.contract.stopping import STOPPING


class UnderWay:
    """Requests that are being carried out."""

    def __init__(self, most: int) -> None:
        """Have room for ``most`` requests of each kind."""
        self._most = most
        self._most_of_a_client = max(1, most // 2)
        self._requests: dict[asyncio.Task[None], tuple[bytes, Request[Any]]] = {}

    def begin(self, task: "asyncio.Task[None]", identity: bytes, request: Request[Any]) -> None:
        """Take note of one, until its task ends."""
        self._requests[task] = identity, request
        task.add_done_callback(self._requests.pop)

    def no_room(self, identity: bytes, request: Request[Any]) -> str | None:
        """Say why there is no room for a request of a client; None if there is."""
        kind = _kind(request)
        clients = [client for client, other in self._requests.values() if _kind(other) == kind]
        if len(clients) >= self._most:
            return f"{self._most} requests are under way"
        if not kind and clients.count(identity) >= self._most_of_a_client:
            return f"{self._most_of_a_client} requests of this client are under way"
        return None

    def arming(self) -> "list[asyncio.Task[None]]":
        """Return the tasks that a stop ends."""
        return [task for task, (_, request) in self._requests.items() if isinstance(request, Arm)]


def _kind(request: Request[Any]) -> str:
    """Return what a request shares room with: stops, renewals, or (empty) all the rest."""
    return "stop" if isinstance(request, STOPPING) else "renew" if isinstance(request, Renew) else ""
