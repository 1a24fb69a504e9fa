"""The requests under way, and whether there is room for one more.

Stops and renewals have room of their own each, so that what takes long cannot keep one from its answer. Of the rest no
client may take more than half; and as much again is kept for clients that ask seldom. Maps are megabytes each, and ways
are found on all of one: two at a time.
"""

import asyncio
from typing import Any

from robotd.contract.request import Request
from robotd.contract.requests import Arm, MapShow, PlanTo, Renew
from robotd.contract.stopping import STOPPING

_MAPS = 2


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

    def no_room(self, identity: bytes, request: Request[Any], *, seldom: bool) -> str | None:
        """Say why there is no room for a request of a client, which may ask seldom; None if there is."""
        kind = _kind(request)
        clients = [client for client, other in self._requests.values() if _kind(other) == kind]
        if len(clients) >= self._room(kind, seldom=seldom):
            return f"{len(clients)} requests like this one are under way"
        if not kind and clients.count(identity) >= self._most_of_a_client:
            return f"{self._most_of_a_client} requests of this client are under way"
        return None

    def _room(self, kind: str, *, seldom: bool) -> int:
        if kind == "map":
            return _MAPS
        return 2 * self._most if seldom and not kind else self._most

    def arming(self) -> "list[asyncio.Task[None]]":
        """Return the tasks that a stop ends."""
        return [task for task, (_, request) in self._requests.items() if isinstance(request, Arm)]


def _kind(request: Request[Any]) -> str:
    """Return what a request shares room with: stops, renewals, maps, or (empty) all the rest."""
    if isinstance(request, STOPPING):
        return "stop"
    return "renew" if isinstance(request, Renew) else "map" if isinstance(request, MapShow | PlanTo) else ""
