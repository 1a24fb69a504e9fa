"""What each command does: a table from its type to a few lines on :class:`Control`."""

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any

from robotd import __version__
from robotd.contract import requests as api
from robotd.contract.events import MapChanged, Status
from robotd.contract.map_wire import MapPayload, pack_map
from robotd.contract.requests import Command, Done, ErrorCode, RecordingFile
from robotd.core.clock import now_ns, wall_offset_ns
from robotd.core.errors import ConfigError, MapError, RobotdError, ServerError
from robotd.server.control import Control
from robotd.server.map_entries import entry_info
from robotd.server.outcomes import Outcomes

_CODES: tuple[tuple[type[RobotdError], ErrorCode], ...] = (
    (MapError, ErrorCode.NOT_FOUND),
    (ConfigError, ErrorCode.BAD_ARGUMENT),
    (RobotdError, ErrorCode.REFUSED),
)


def as_refusal(error: RobotdError) -> ServerError:
    """Return the reply to a request that ended with an error."""
    if isinstance(error, ServerError):
        return error
    return ServerError(next(code for kind, code in _CODES if isinstance(error, kind)), str(error))


class Handlers:
    """Carries commands out."""

    def __init__(self, control: Control, outcomes: Outcomes, session: str, lease_s: float) -> None:
        self._control = control
        self._outcomes = outcomes
        self._session = session
        self._lease_s = lease_s
        self._table: dict[type[Command[Any]], Callable[[Any], Awaitable[object]]] = {
            api.Hello: self._hello,
            api.GetStatus: self._status,
            api.GetConfig: self._config,
            api.Arm: self._arm,
            api.Disarm: self._stopped,
            api.Stop: self._stopped,
            api.Clear: self._clear,
            api.MapStart: self._start,
            api.Localize: self._start,
            api.DriveTo: self._start,
            api.Renew: self._renew,
            api.MapSave: self._map_save,
            api.MapLoad: self._map_load,
            api.MapDiscard: self._map_discard,
            api.ListMaps: self._map_list,
            api.MapShow: self._map_show,
            api.RecordStart: self._record_start,
            api.RecordStop: self._record_stop,
        }

    def halt(self, command: Command[Any]) -> None:
        """Obey a command that stops the robot, at once; :meth:`carry_out` then waits for the mission's end."""
        self._control.halt(command.reason if isinstance(command, api.Stop) else "disarmed by request")

    async def carry_out(self, command: Command[Any]) -> object:
        """Return what a command answers.

        Raises:
            RobotdError: why it was not done.
        """
        return await self._table[type(command)](command)

    async def _hello(self, _: api.Hello) -> api.HelloResult:
        return api.HelloResult(
            versions=(api.VERSION,),
            robotd=__version__,
            session=self._session,
            lease_s=self._lease_s,
            time_ns=now_ns(),
            wall_offset_ns=wall_offset_ns(),
        )

    async def _status(self, _: api.GetStatus) -> Status:
        return self._control.status

    async def _config(self, _: api.GetConfig) -> api.ConfigText:
        return api.ConfigText(self._control.config_text)

    async def _arm(self, _: api.Arm) -> Done:
        await self._control.arm()
        return Done()

    async def _stopped(self, _: api.Stop | api.Disarm) -> Done:
        await self._control.stopped()
        return Done()

    async def _clear(self, _: api.Clear) -> Done:
        await self._control.clear()
        return Done()

    async def _start(self, command: api.StartCommand) -> api.MissionStarted:
        lease_s = self._lease_s if command.lease_s is None else command.lease_s
        return api.MissionStarted(await self._control.begin(command.mission, lease_s), lease_s)

    async def _renew(self, command: api.Renew) -> api.Renewed:
        await asyncio.sleep(0)  # what was published before the request came has then been noted
        progress = self._outcomes.latest(command.mission_id)
        if progress is None or not progress.is_last:
            self._control.renew(command.mission_id)
        return api.Renewed(progress)

    async def _map_save(self, command: api.MapSave) -> api.MapEntryInfo:
        try:
            return entry_info(await self._control.save_map(command.name))
        except MapError as error:
            if self._control.status.map_id is None:
                raise
            raise ServerError(ErrorCode.REFUSED, str(error)) from error  # there is a map, but no room for it

    async def _map_load(self, command: api.MapLoad) -> api.MapEntryInfo:
        pose = command.robot_in_map.pose if command.robot_in_map else None
        return entry_info(await self._control.load_map(command.name, command.version, pose))

    async def _map_discard(self, _: api.MapDiscard) -> Done:
        self._control.discard_map()
        return Done()

    async def _map_list(self, _: api.ListMaps) -> api.MapList:
        return api.MapList(tuple(entry_info(entry) for entry in await self._control.list_maps()))

    async def _map_show(self, command: api.MapShow) -> MapPayload:
        return await asyncio.to_thread(pack_map, await self._map(command))

    async def _map(self, command: api.MapShow) -> MapChanged:
        if command.name is not None:
            return await self._control.stored_map(command.name, command.version)
        if command.version is not None:
            raise ServerError(ErrorCode.BAD_ARGUMENT, "map_show: a version needs a name")
        return self._control.whole_map()

    async def _record_start(self, command: api.RecordStart) -> RecordingFile:
        return RecordingFile(await self._control.start_recording(command.path))

    async def _record_stop(self, _: api.RecordStop) -> RecordingFile:
        return RecordingFile(await self._control.stop_recording())
