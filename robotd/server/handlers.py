"""What the server knows by itself of a request, before the mission is asked: who we are, the lease, how far it came."""

import asyncio
from typing import Any

from robotd import __version__
from robotd.contract.answers import Done, ErrorCode, HelloResult, Renewed
from robotd.contract.events import MissionProgress
from robotd.contract.missions import Mission, with_lease
from robotd.contract.plain import VERSION
from robotd.contract.request import Request
from robotd.contract.requests import Disarm, Hello, Renew, Stop
from robotd.core.clock import now_ns, wall_offset_ns
from robotd.core.errors import ConfigError, MapError, RobotdError, ServerError
from robotd.server.control import Control
from robotd.server.outcomes import Outcomes

_TURNS_TO_THE_END = 50

_CODES: tuple[tuple[type[RobotdError], ErrorCode], ...] = (
    (MapError, ErrorCode.NOT_FOUND),
    (ConfigError, ErrorCode.BAD_ARGUMENT),
    (RobotdError, ErrorCode.REFUSED),  # last, for all the others are of its kind too
)


def as_refusal(error: RobotdError) -> ServerError:
    """Return the reply to a request that ended with an error."""
    if isinstance(error, ServerError):
        return error
    return ServerError(next(code for kind, code in _CODES if isinstance(error, kind)), str(error))


class Handlers:
    """Has requests carried out."""

    def __init__(self, control: Control, outcomes: Outcomes, session: str, lease_s: float) -> None:
        self._control = control
        self._outcomes = outcomes
        self._session = session
        self._lease_s = lease_s

    def halt(self, request: Stop | Disarm) -> None:
        """Obey a request that stops the robot, at once; :meth:`carry_out` then waits for the mission's end."""
        self._control.halt(request)

    async def carry_out(self, request: Request[Any]) -> object:
        """Return what a request is answered.

        Raises:
            RobotdError: why it was not done.
        """
        match request:
            case Hello():
                return self._hello()
            case Stop() | Disarm():
                await self._control.stopped()
                return Done()
            case Renew():
                return await self._renew(request)
        if isinstance(request, Mission) and request.lease_s is None:
            request = with_lease(request, self._lease_s)
        return await self._control.perform(request)

    def _hello(self) -> HelloResult:
        return HelloResult(
            versions=(VERSION,),
            robotd=__version__,
            session=self._session,
            lease_s=self._lease_s,
            time_ns=now_ns(),
            wall_offset_ns=wall_offset_ns(),
        )

    async def _renew(self, request: Renew) -> Renewed:
        try:
            await asyncio.sleep(0)  # what was published before the request came has then been noted
            progress = self._outcomes.latest(request.mission_id)
            if progress is None or not progress.is_last:
                await self._control.perform(request)
        except RobotdError:
            # Between a mission's last step and the word of it lie a few turns of the loop. When it is over there is no
            # lease left to renew, and to refuse would hide from the client how it ended.
            progress = await self._end_of(request.mission_id)
            if progress is None:
                raise
        return Renewed(progress)

    async def _end_of(self, mission_id: int) -> MissionProgress | None:
        for _ in range(_TURNS_TO_THE_END):
            progress = self._outcomes.latest(mission_id)
            if progress is not None and progress.is_last:
                return progress
            await asyncio.sleep(0)
        return None
