"""The server meets a mission that is only a pair of queues: bytes in, bytes out, and no object that both know.

The bytes are those of the wire, as every request, answer and event of the contract has such a form. It is how the
mission may some day live in another process; the server would not notice.
"""

import asyncio
import contextlib
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pytest

from robotd.client import AsyncClient
from robotd.contract.answers import Done, ErrorCode, MissionStarted, Renewed
from robotd.contract.envelope import (
    NumberedRequest,
    decode_reply,
    decode_request,
    encode_error,
    encode_request,
    encode_result,
)
from robotd.contract.estimate import PoseState
from robotd.contract.events import Event, MissionPhase, MissionProgress, Status
from robotd.contract.missions import Localize
from robotd.contract.plain import from_plain
from robotd.contract.request import Request
from robotd.contract.requests import Arm, Disarm, GetStatus, MapShow, Renew, Stop
from robotd.contract.topics import LogEntry, decode_frame, encode_frame, to_wire
from robotd.core.broadcast import Broadcast
from robotd.core.errors import ServerError
from robotd.server.server import Server, ServerSettings
from tests.unit.server.conftest import an_estimate, whole_map

pytestmark = pytest.mark.real_clock

R = TypeVar("R")

REPLY, EVENT = b"r", b"e"
DEPTH = 100


class Queues:
    """The server's end: a Control that knows two queues and nothing else."""

    def __init__(self, asked: asyncio.Queue[bytes], said: asyncio.Queue[bytes]) -> None:
        self.events: Broadcast[Event] = Broadcast()
        self._asked = asked
        self._said = said
        self._number = 0
        self._waiting: dict[int, asyncio.Future[dict[str, Any]]] = {}
        self._stops: set[asyncio.Future[dict[str, Any]]] = set()

    def halt(self, request: Stop | Disarm) -> None:
        answered = self._ask(request)
        self._stops.add(answered)
        answered.add_done_callback(self._stops.discard)

    async def stopped(self) -> None:
        await asyncio.gather(*self._stops)

    async def perform(self, request: Request[R]) -> R:
        answer: R = from_plain(request.result, await self._ask(request))
        return answer

    async def run(self) -> None:
        while True:
            data = await self._said.get()
            if data[:1] == REPLY:
                self._answer(data[1:])
            else:
                event = decode_frame(data[1:]).event
                assert event is not None
                assert not isinstance(event, LogEntry)
                self.events.publish(event)

    def _ask(self, request: Request[Any]) -> asyncio.Future[dict[str, Any]]:
        self._number += 1
        self._asked.put_nowait(encode_request(self._number, request))
        answered = self._waiting[self._number] = asyncio.get_running_loop().create_future()
        return answered

    def _answer(self, data: bytes) -> None:
        reply = decode_reply(data)
        assert reply.id is not None
        waiting = self._waiting.pop(reply.id)
        if waiting.cancelled():
            return  # a stop overtook it
        if isinstance(reply.result, ServerError):
            waiting.set_exception(reply.result)
        else:
            waiting.set_result(reply.result)


class ScriptedMission:
    """The mission's end: takes bytes, gives bytes."""

    def __init__(self, asked: asyncio.Queue[bytes], said: asyncio.Queue[bytes]) -> None:
        self._asked = asked
        self._said = said
        self.taken: list[Request[Any]] = []
        self.is_armed = False
        self.leaves_open: type[Request[Any]] | None = None
        self._took = asyncio.Condition()

    async def took(self, kind: type[Request[Any]]) -> None:
        async with self._took:
            await self._took.wait_for(lambda: any(isinstance(request, kind) for request in self.taken))

    async def run(self) -> None:
        while True:
            numbered = decode_request(await self._asked.get(), 65536)
            assert isinstance(numbered, NumberedRequest)
            async with self._took:
                self.taken.append(numbered.request)
                self._took.notify_all()
            if type(numbered.request) is self.leaves_open:
                continue
            try:
                self._said.put_nowait(REPLY + encode_result(numbered.id, self._answer_to(numbered.request)))
            except ServerError as error:
                self._said.put_nowait(REPLY + encode_error(numbered.id, error))
            if isinstance(numbered.request, Localize):
                self._localize()

    def _answer_to(self, request: Request[Any]) -> object:
        match request:
            case Arm() | Stop() | Disarm():
                self.is_armed = isinstance(request, Arm)
                return Done()
            case GetStatus():
                mode = "idle" if self.is_armed else "disarmed"
                return Status(5, mode, "scripted", (), 24.5, (), None, None, None, None)
            case MapShow():
                return whole_map(1)
            case Renew():
                return Renewed(None)
            case Localize() if self.is_armed:
                assert request.lease_s is not None
                return MissionStarted(1, request.lease_s)
        raise ServerError(ErrorCode.REFUSED, f"cannot {request.cmd} now")

    def _localize(self) -> None:
        self._tell(MissionProgress(6, 1, "localize", MissionPhase.STARTED, 0, 1))
        self._tell(an_estimate(PoseState.LOCALIZED))
        self._tell(MissionProgress(9, 1, "localize", MissionPhase.DONE, 1, 1, "found"))

    def _tell(self, event: Event) -> None:
        topic, fields = to_wire(event)
        self._said.put_nowait(EVENT + encode_frame(topic, "", 0, fields))


@contextlib.asynccontextmanager
async def served(runtime_dir: Path) -> AsyncIterator[ScriptedMission]:
    pair: tuple[asyncio.Queue[bytes], asyncio.Queue[bytes]] = asyncio.Queue(DEPTH), asyncio.Queue(DEPTH)
    server_end, mission_end = Queues(*pair), ScriptedMission(*pair)
    server = Server(ServerSettings(runtime_dir=str(runtime_dir)), server_end)
    tasks = [asyncio.create_task(part) for part in (server_end.run(), mission_end.run(), server.run())]
    await server.serving.wait()
    try:
        yield mission_end
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
    for task in tasks:
        assert task.cancelled(), task.exception()


async def test_a_client_cannot_tell_it_from_the_real_one(tmp_path: Path) -> None:
    async with served(tmp_path) as mission, AsyncClient(tmp_path) as robot:
        assert (await robot.hello()).versions == (1,)
        assert (await robot.status()).mode == "disarmed"
        with pytest.raises(ServerError, match="cannot localize now"):
            await robot.localize()
        await robot.arm()
        assert (await robot.status()).mode == "idle"
        found = await robot.localize(0.5)
        assert found == an_estimate(PoseState.LOCALIZED)
        assert mission.taken.count(Localize(0.5, lease_s=ServerSettings().lease_s)) == 1
        np.testing.assert_array_equal((await robot.map_show()).values, whole_map(1).values)
        with pytest.raises(ServerError, match="cannot map_save now"):
            await robot.map_save("office")
        with robot.subscribe("status", "pose") as events:
            assert {type(await events.next(5)) for _ in range(2)} >= {Status}
        await robot.stop("enough")
        assert mission.taken[-1] == Stop("enough")
        assert (await robot.status()).mode == "disarmed"


async def test_a_stop_goes_in_while_an_arm_is_not_answered_and_overtakes_it(tmp_path: Path) -> None:
    async with served(tmp_path) as mission, AsyncClient(tmp_path) as robot:
        mission.leaves_open = Arm
        arming = asyncio.create_task(robot.arm())
        await mission.took(Arm)
        await robot.stop("enough")
        assert mission.taken[-1] == Stop("enough")
        with pytest.raises(ServerError, match="overtaken by a stop"):
            await arming
