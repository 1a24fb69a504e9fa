"""What a browser asks for, carried out: checked against its role, sent once, answered with what the daemon said."""

from collections.abc import Callable
from typing import Any

import msgspec

from robotd.contract.map_import import MapImport
from robotd.contract.missions import MissionRequest
from robotd.contract.plain import to_plain
from robotd.contract.request import Request
from robotd.contract.requests import REQUESTS, Arm, Hello, MapShow, Renew, Stop
from robotd.contract.stopping import STOPPING
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import RobotdError, ServerError
from robotd.gateway.access.roles import Role, role_for
from robotd.gateway.command.asker import Asks
from robotd.gateway.command.idle import Idle

_NOT_FOR_BROWSERS = {Hello.cmd, Renew.cmd, MapShow.cmd, MapImport.cmd}
"""The gateway says hello and renews itself; maps are bytes, and have addresses of their own."""


def request_of(name: str, arguments: dict[str, Any], role: Role) -> Request[Any]:
    """Return the request that a browser means.

    Raises:
        ServerError: there is no such command, its arguments are not what it takes, or the role is not enough.
    """
    kind = REQUESTS.get(name)
    if kind is None or name in _NOT_FOR_BROWSERS:
        raise ServerError("unknown_command", f"no command {name[:40]!r} for browsers")
    needed = role_for(kind)
    if kind not in STOPPING and not role.may(needed):
        raise ServerError("not_allowed", f"{name} needs the role {needed}, and this session has {role}")
    try:
        request: Request[Any] = msgspec.convert(arguments, kind, strict=True)
    except msgspec.ValidationError as error:
        if kind is Stop:
            return Stop.because(arguments.get("reason"))
        raise ServerError("bad_argument", f"{name}: {error}") from error
    return request


class PageCommands:
    """Sends what is no mission to the daemon."""

    def __init__(self, asker: Asks, idle: Idle, stop: Callable[[str], Any]) -> None:
        """Send by ``asker``; what stops goes by ``stop``, which goes before everything."""
        self._asker, self._idle, self._stop = asker, idle, stop

    async def carry_out(self, request: Request[Any], who: str) -> Any:
        """Return the answer to a request, as plain data.

        Raises:
            ServerError: it was refused, or it is not known whether it was carried out.
        """
        if isinstance(request, MissionRequest):
            raise ServerError(
                "refused", f"{request.cmd} is a mission: missions are started from a page that stays open"
            )
        if isinstance(request, STOPPING):
            await self._stop(f"{request.cmd} by {who}")
            return {}
        try:
            answer = await self._asker.ask(request, who=f"{who}, in the console")
        except ServerError:
            raise
        except RobotdError as error:
            raise ServerError("internal", str(error)) from error
        if isinstance(request, Arm):
            self._idle.armed(now_ns() / NS_PER_S)
        return to_plain(answer)
