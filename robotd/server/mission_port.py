"""What the server needs of the mission: requests in, answers and events out, all of them data of the contract.

Nothing else is shared, so the mission may be a pair of queues, or another process.
"""

from typing import Protocol, TypeVar

from robotd.contract.request import Request
from robotd.contract.requests import Disarm, Stop
from robotd.contract.topics import Published, Topic
from robotd.core.broadcast import Broadcast

R = TypeVar("R")


class MissionPort(Protocol):
    """The mission, as far as clients may reach."""

    @property
    def events(self) -> Broadcast[Published]:
        """Everything that happens, and what the log says of it."""

    def halt(self, request: Stop | Disarm) -> None:
        """Stop everything and disarm; valid at any time. The stop is on its way when this returns."""

    def watch(self, topics: frozenset[Topic]) -> None:
        """Say what somebody reads: what is costly is made for these topics alone. It may be lost, and is said again."""

    async def stopped(self) -> None:
        """Wait until the mission that was stopped has ended."""

    async def perform(self, request: Request[R], client: str = "") -> R:
        """Carry out a request, every one but ``hello``, and return its answer; ``client`` says who asks.

        A mission comes with its lease, and an ``arm`` is cancelled when a stop overtakes it.

        Raises:
            RobotdError: why it was not done; :func:`robotd.contract.refusal.as_refusal` says what becomes of it.
        """
