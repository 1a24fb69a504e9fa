"""What the server knows by itself of a request, before the mission is asked: who we are, and the lease."""

from typing import Any

from robotd import __version__
from robotd.contract.answers import Done, HelloResult
from robotd.contract.metrics import Metrics
from robotd.contract.missions import Mission, with_lease
from robotd.contract.plain import VERSION
from robotd.contract.request import Request
from robotd.contract.requests import Disarm, GetMetrics, Hello, Stop
from robotd.core.clock import now_ns, wall_offset_ns
from robotd.core.counted import Counted
from robotd.server.mission_port import MissionPort


class Handlers:
    """Has requests carried out."""

    def __init__(self, control: MissionPort, session: str, lease_s: float, counted: Counted) -> None:
        self._control = control
        self._session = session
        self._lease_s = lease_s
        self._counted = counted

    def halt(self, request: Stop | Disarm) -> None:
        """Obey a request that stops the robot, at once; :meth:`carry_out` then waits for the mission's end."""
        self._control.halt(request)

    async def carry_out(self, request: Request[Any], client: str) -> object:
        """Return what a request of this client is answered.

        Raises:
            RobotdError: why it was not done.
        """
        match request:
            case Hello():
                return self._hello()
            case Stop() | Disarm():
                await self._control.stopped()
                return Done()
            case GetMetrics():
                # Two processes count, and a client wants one answer.
                return (await self._control.perform(request, client)).joined(Metrics.of(self._counted))
        # Filled in here, where the setting is: the journal then has the lease that counted.
        if isinstance(request, Mission) and request.lease_s is None:
            request = with_lease(request, self._lease_s)
        return await self._control.perform(request, client)

    def _hello(self) -> HelloResult:
        return HelloResult(
            versions=(VERSION,),
            robotd=__version__,
            session=self._session,
            lease_s=self._lease_s,
            time_ns=now_ns(),
            wall_offset_ns=wall_offset_ns(),
        )
