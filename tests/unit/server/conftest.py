"""A daemon that is all front: real sockets in a temporary directory, and a fake robot behind them."""

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager
from pathlib import Path
from typing import Any, TypeVar

import msgspec
import numpy as np
import pytest

from robotd.contract.answers import ConfigText, Done, MapEntryInfo, MapList, MissionStarted, RecordingFile, Renewed
from robotd.contract.device_status import DeviceStatus, LinkState
from robotd.contract.estimate import Circle, Cover, Extent, PoseEstimate, PoseState, Region
from robotd.contract.events import (
    Event,
    MapChanged,
    MissionPhase,
    MissionProgress,
    RangeMeasured,
    Status,
    SweepDone,
    SweepProgress,
)
from robotd.contract.map_import import MapImport, MapImported
from robotd.contract.metrics import Metrics
from robotd.contract.missions import Measure, Mission, Scan
from robotd.contract.modes import Mode
from robotd.contract.request import Request
from robotd.contract.requests import (
    Arm,
    Clear,
    Disarm,
    GetConfig,
    GetMetrics,
    GetStatus,
    ListMaps,
    MapDelete,
    MapDiscard,
    MapLoad,
    MapRename,
    MapSave,
    MapShow,
    PlanTo,
    RecordDelete,
    RecordStart,
    RecordStop,
    Renew,
    Stop,
)
from robotd.contract.topics import Topic
from robotd.contract.ways import Way
from robotd.core.broadcast import Broadcast
from robotd.core.clock import now_ns
from robotd.core.counted import Counted
from robotd.core.errors import MapError, MissionError
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import IDENTITY, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.mission.safety.lease import Lease
from robotd.server.settings import ServerSettings
from tests.support.served import served

R = TypeVar("R")

SPEC = GridSpec(0.05, -1.0, -2.0, (40, 60))


def stored_entry(name: str, version: int, digest: str, created_unix_ns: int) -> MapEntryInfo:
    return MapEntryInfo(name, version, digest, created_unix_ns, 40, 60, 0.05)


def stored_map(name: str, version: int | None) -> MapChanged:
    """What is in the store of the fake robot: of version 2 all is free."""
    if name != "office":
        raise MapError(f"there is no map {name!r}")
    stored = whole_map(generation=0, map_id=f"office-{version or 3}")
    if version == 2:
        stored.values[:] = 20
    return stored


class FakeControl:
    """A robot whose missions are three readings long and wait at the end until ``release`` is set."""

    def __init__(self) -> None:
        self.events: Broadcast[Event] = Broadcast()
        self.calls: list[str] = []
        self.performed: list[Request[Any]] = []
        self.watched: list[frozenset[Topic]] = []
        self.clients: list[str] = []
        """Who asked for each."""
        self.release = asyncio.Event()
        self.release.set()
        self.arming = asyncio.Event()
        self.arming.set()
        self.begun = asyncio.Event()
        self.halted = asyncio.Event()
        self.armed = False
        self.map_in_use: MapChanged | None = None
        self.stored = [stored_entry("office", 3, "d2", 6)]
        self.mission_id = 0
        self.asked: list[Mission] = []
        self.leases_s: list[float] = []
        self._mission: asyncio.Task[None] | None = None
        self._lease: Lease | None = None
        self._recording: str | None = None
        self._stop_reason = ""
        self._halts = 0
        self.given_up = 0
        """Armings that were cancelled."""

    @property
    def is_busy(self) -> bool:
        return self._mission is not None and not self._mission.done()

    @property
    def status(self) -> Status:
        return Status(
            time_ns=now_ns(),
            mode=Mode.IDLE if self.armed else Mode.DISARMED,
            reason="fake",
            devices=(DeviceStatus("drive", LinkState.READY, armed=self.armed, counters=(("frames", 7),)),),
            battery_v=24.5,
            bumpers_rad=(0.5,),
            mission_id=self.mission_id if self.is_busy else None,
            map_id=None if self.map_in_use is None else self.map_in_use.map_id,
            map_name=None if self.map_in_use is None else "office",
            recording=self._recording,
        )

    def halt(self, request: Stop | Disarm) -> None:
        self.calls.append(f"stop: {request.reason}")
        self.armed = False
        self._halts += 1
        if not self.arming.is_set():  # an arming under way ends of a stop
            self.arming.set()
            self.arming.clear()
        self.halted.set()
        self._stop_reason = request.reason
        if self._mission is not None:
            self._mission.cancel()

    async def stopped(self) -> None:
        if self._mission is not None:
            await asyncio.wait((self._mission,))

    def watch(self, topics: frozenset[Topic]) -> None:
        if self.watched[-1:] != [topics]:
            self.watched.append(topics)

    async def perform(self, request: Request[R], client: str = "") -> R:
        self.performed.append(request)
        self.clients.append(client)
        answer: R = await self._answer(request)
        return answer

    async def _answer(self, request: Request[Any]) -> Any:
        match request:
            case GetStatus():
                return self.status
            case GetMetrics():
                counted = Counted()
                counted.count("stops_total", 3, cause="stop")
                return Metrics.of(counted)
            case GetConfig():
                return ConfigText("[server]\nlease_s = 0.5\n")
            case Arm():
                return await self._arm()
            case Clear():
                raise RuntimeError("a bug in the daemon")
            case Renew(mission_id):
                return self._renew(mission_id)
            case RecordStart(path):
                self._recording = path or "robot.mcap"
                return RecordingFile(self._recording)
            case RecordStop():
                path, self._recording = self._recording, None
                return RecordingFile(path)
        return self._begin(request) if isinstance(request, Mission) else self._of_maps(request)

    def _of_maps(self, request: Request[Any]) -> Any:
        match request:
            case MapShow(None):
                if self.map_in_use is None:
                    raise MapError("no map in use")
                return self.map_in_use
            case MapShow(str(name), version):
                return stored_map(name, version)
            case MapSave(name):
                self.calls.append(f"save {name}")
                return stored_entry(name or "unnamed", 4, "d1", 5)
            case MapLoad(name, version, robot_in_map):
                self.calls.append(f"load {name} {version} {robot_in_map.pose if robot_in_map else None}")
                return stored_entry(name, version or 3, "d2", 6)
            case MapDiscard():
                self.calls.append("discard")
                return Done()
            case PlanTo(x_m, y_m):
                return Way(((x_m, 0.0), (x_m, y_m)), 3.2)
            case MapImport():
                is_last = request.offset_bytes + len(request.part) == request.size_bytes
                self.calls.append(f"import {request.name} of {request.imported_from} {request.rows} x {request.cols}")
                return MapImported(7, stored_entry(request.name, 1, "d3", 0) if is_last else None)
            case ListMaps():
                return MapList(tuple(self.stored))
        return self._of_removals(request)

    def _of_removals(self, request: Request[Any]) -> Done:
        match request:
            case MapDelete(name, version) | MapRename(name, version):
                self.calls.append(f"{request.cmd} {name} {version}")
            case RecordDelete(path):
                self.calls.append(f"record_delete {path}")
            case _:
                raise AssertionError(f"{request} is for the server alone")
        return Done()

    async def _arm(self) -> Done:
        self.calls.append("arm")
        halts = self._halts
        try:
            await self.arming.wait()
        except asyncio.CancelledError:
            self.given_up += 1
            raise
        if self._halts != halts:
            raise MissionError("stopped while arming")
        self.armed = True
        return Done()

    def _begin(self, mission: Mission) -> MissionStarted:
        if not self.armed or self.is_busy:
            raise MissionError("not now")
        self.calls.append("start")
        lease_s = mission.lease_s
        assert lease_s is not None, "the server says which lease"
        self.asked.append(msgspec.structs.replace(mission, lease_s=None))
        self.leases_s.append(lease_s)
        self.mission_id += 1
        self.begun.set()
        self._lease = Lease(lease_s, self._lease_expired)
        self._mission = asyncio.create_task(self._run(self.mission_id, mission))
        return MissionStarted(self.mission_id, lease_s)

    def _renew(self, mission_id: int) -> Renewed:
        if not self.is_busy or mission_id != self.mission_id or self._lease is None:
            raise MissionError(f"mission {mission_id} is not under way")
        self._lease.renew()
        return Renewed(None)

    async def close(self) -> None:
        if self._mission is not None:
            self._mission.cancel()
            await asyncio.wait((self._mission,))

    def _lease_expired(self) -> None:
        self._stop_reason = "lease expired"
        if self._mission is not None:
            self._mission.cancel()

    def _progress(self, mission_id: int, mission: Mission, phase: MissionPhase, message: str = "") -> None:
        self.events.publish(MissionProgress(now_ns(), mission_id, mission.kind, phase, 0, 1, message))

    async def _run(self, mission_id: int, mission: Mission) -> None:
        try:
            self._progress(mission_id, mission, MissionPhase.STARTED)
            for taken in (1, 2, 3):
                self.events.publish(SweepProgress(now_ns(), 0, taken, 3, taken, 0, 0))
            for event in _results_of(mission):
                self.events.publish(event)
            self.events.publish(an_estimate(PoseState.AMBIGUOUS))
            await self.release.wait()
            self.events.publish(an_estimate(PoseState.LOCALIZED))
            self._progress(mission_id, mission, MissionPhase.DONE, "found")
        except asyncio.CancelledError:
            self._progress(mission_id, mission, MissionPhase.STOPPED, self._stop_reason)
            raise
        finally:
            if self._lease is not None:
                self._lease.end()


def _results_of(mission: Mission) -> list[Event]:
    if isinstance(mission, Measure):
        return [RangeMeasured(9, number, mission.count, ReadingStatus.OK, 1.5, None) for number in range(mission.count)]
    if isinstance(mission, Scan):
        return [SweepDone(9, Sweep(3, IDENTITY, (RangeReading(9, 0.5, ReadingStatus.OK, 1.5),)))]
    return []


def an_estimate(state: PoseState, time_ns: int = 9) -> PoseEstimate:
    """A pose as a robot would publish it."""
    region = Region(
        belief=0.98,
        pose=Pose2(1.0, 2.0, 0.25),
        covariance=((1e-4, 0.0, 0.0), (0.0, 1e-4, 0.0), (0.0, 0.0, 1e-5)),
        residual_m=0.02,
        centre=Pose2(1.0, 2.0, 0.25),
        extent=Extent(0.9, 1.1, 1.9, 2.1, -0.1, 0.1),
        circle=Circle(1.0, 2.0, 0.15),
        cover=Cover(1, ((40, 20, 21), (41, 20, 21))),
        cells=4,
        poses=12,
        best_rank=280,
        explained=(True,) * 280 + (False,) * 20,
    )
    return PoseEstimate(time_ns, state, Pose2(1.0, 2.0, 0.25), (region,), 280, 300, True, "d1")


def whole_map(generation: int, map_id: str = "d1", spec: GridSpec = SPEC) -> MapChanged:
    """A map of noise, which does not compress."""
    cells = np.random.default_rng(generation).integers(0, 256, spec.shape, dtype=np.uint8)
    return MapChanged(1, map_id, generation, spec, True, np.empty(0, dtype=np.intp), cells)


@pytest.fixture
def make_map() -> Callable[..., MapChanged]:
    """The function above, for the tests."""
    return whole_map


@pytest.fixture
def make_estimate() -> Callable[..., PoseEstimate]:
    """The function above, for the tests."""
    return an_estimate


@pytest.fixture
def make_control() -> type[FakeControl]:
    """The fake, to be made inside a running loop."""
    return FakeControl


Serving = Callable[..., AbstractAsyncContextManager[FakeControl]]


@pytest.fixture
def serving(tmp_path: Path) -> Serving:
    """``async with serving(lease_s=...) as control``: a server on ``tmp_path`` for the length of the block."""

    @contextlib.asynccontextmanager
    async def serve(control: FakeControl | None = None, **settings: float) -> AsyncIterator[FakeControl]:
        control = FakeControl() if control is None else control
        try:
            async with served(control, ServerSettings(runtime_dir=str(tmp_path), **settings)):  # type: ignore[arg-type]  # ints and floats by keyword
                yield control
        finally:
            await control.close()

    return serve
