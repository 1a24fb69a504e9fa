"""The whole program in memory, on the virtual clock: real signals, and every wire watched."""

import asyncio
import contextlib
import random
import signal
import tempfile
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any
from unittest import mock

from robotd.app import daemon as program
from robotd.app.compose import Daemon, compose
from robotd.cli.emulated import config_text
from robotd.config import Config, loads
from robotd.contract.missions import Mission
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import RobotdError
from robotd.front import supervised
from robotd.hardware.transport.transport import Connect, Transport
from robotd.hardware.wire.board import STOP_BYTES
from robotd.head.compute import Compute
from robotd.head.head import Head
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.recording.preroll import PrerollJournal
from robotd.sim.buildings.world import load_world
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.robot import DEVICES, SimulatedRobot
from robotd.sim.runtime import connectors
from tests.support.places import NearHead, near_front

LEASE_S = 5.0
READINGS = 24


class Wire:
    """An end of a line on which is noted when a stop was written, and which goes dead when its daemon is killed."""

    def __init__(self, line: Transport, stop: bytes) -> None:
        self.name = line.name
        self.opened_ns = now_ns()
        self.stops_ns: list[int] = []
        self.is_dead = False
        self._line = line
        self._stop = stop

    async def read(self) -> bytes:
        return await self._line.read()

    def write(self, data: bytes) -> None:
        self._write(self._line.write, data)

    def write_urgent(self, data: bytes) -> None:
        self._write(self._line.write_urgent, data)

    def write_past_loop(self, data: bytes) -> None:
        self._write(self._line.write, data)  # in memory the stall is ours to make, and so is this

    def close(self) -> None:
        self._line.close()

    def cut(self) -> None:
        """Cut it, at both ends."""
        self._line.cut()  # type: ignore[attr-defined]  # a memory line can be cut

    def _write(self, write: Callable[[bytes], None], data: bytes) -> None:
        if self.is_dead:
            return
        if self._stop and self._stop in data:
            self.stops_ns.append(now_ns())
        write(data)


ALWAYS_LIT = ("tfmini", "tfmini-s", "tfmini-plus", "tf-luna")
"""Their light cannot be switched off."""


@dataclass(slots=True)
class Rig:
    """A robot that outlives its daemons."""

    robot: SimulatedRobot
    config: Config
    connects: Mapping[str, Connect]
    random: random.Random
    wires: dict[str, Wire] = field(default_factory=dict)
    tasks: list["asyncio.Task[Any]"] = field(default_factory=list)
    """What a cause has asked for."""
    composed: "asyncio.Future[Daemon] | None" = None

    @property
    def is_moving(self) -> bool:
        """Whether the base or the head moves, or a laser shines that can be switched off."""
        now_us = self.robot.clocks["drive"].board_us(now_ns() // 1000)
        self.robot.boards["drive"].advance(now_us)  # a base without a host may have nothing to wake for
        shines = self.robot._laser._on and self.config.rangefinder.dialect not in ALWAYS_LIT
        return not self.robot.at_rest or self.robot._head.arrives_us is not None or shines

    @contextlib.asynccontextmanager
    async def program(self) -> AsyncIterator[tuple["asyncio.Task[int]", Daemon]]:
        """Run the program as its ``main`` does, on the wires of this robot; what is left in the end is cancelled."""
        self.wires.clear()
        signal.signal(signal.SIGHUP, signal.SIG_DFL)  # nohup would have it ignored, and that is respected
        self.composed = asyncio.get_running_loop().create_future()
        with (
            mock.patch.object(program, "compose", self._compose),
            mock.patch.object(program, "guarded", _unguarded),
            mock.patch.object(program, "FarHead", NearHead),
            mock.patch.object(supervised, "_start", near_front),
        ):
            running = asyncio.create_task(program.run(self.config), name="program")
            try:
                yield running, await self.composed
            finally:
                running.cancel()
                await asyncio.wait({running})

    def _compose(
        self, config: Config, _: Mapping[str, Connect], head: Head, disk: Compute, journal: PrerollJournal
    ) -> Daemon:
        daemon = compose(config, {name: self._watched(name) for name in self.connects}, head, disk, journal)
        assert self.composed is not None
        self.composed.set_result(daemon)
        return daemon

    def _watched(self, name: str) -> Connect:
        async def connect() -> Transport:
            assert self.composed is not None
            device = getattr((await self.composed).robot, name)
            self.wires[name] = Wire(await self.connects[name](), getattr(device, "STOP", STOP_BYTES))
            return self.wires[name]

        return connect

    async def kill(self, running: "asyncio.Task[int]") -> None:
        """End the program without a word on any wire, as ``kill -9`` does."""
        for wire in self.wires.values():
            wire.is_dead = True
        running.cancel()
        running.cancel()
        await asyncio.wait({running})

    def stopped_s(self, since_ns: int, devices: Sequence[str] = DEVICES) -> float | None:
        """Return after what time the stop was on every wire of these that knows one; None if it is not."""
        first_ns = [
            min((at for at in wire.stops_ns if at >= since_ns), default=None)
            for device, wire in self.wires.items()
            if wire._stop and device in devices
        ]
        times_ns = [at for at in first_ns if at is not None]
        if len(times_ns) < len(first_ns) or not times_ns:
            return None
        return (max(times_ns) - since_ns) / NS_PER_S


@contextlib.asynccontextmanager
async def _unguarded(*_: object) -> AsyncIterator[None]:
    """Stand in for the stall guard: it is a thread on the real clock, and here time is virtual."""
    yield


@contextlib.asynccontextmanager
async def rig(dialects: Dialects, seed: int) -> AsyncIterator[Rig]:
    """Put a robot into a room."""
    robot = SimulatedRobot(load_world("laboratory"), seed=seed, dialects=dialects)
    with tempfile.TemporaryDirectory(prefix="robotd-stops-") as directory:
        async with connectors(robot) as connects:
            yield Rig(robot, config_for(dialects, Path(directory)), connects, random.Random(seed))


def config_for(dialects: Dialects, directory: Path) -> Config:
    """Return a configuration for these devices, all of it in a directory."""
    text = config_text({device: f"/dev/emulated/{device}" for device in DEVICES}, dialects.settings())
    config = replace(loads(text), sweep=SweepSettings(readings=READINGS))
    return replace(
        config,
        server=replace(config.server, runtime_dir=str(directory / "run")),
        maps=replace(config.maps, dir=str(directory / "maps")),
        recording=replace(config.recording, dir=str(directory / "recordings")),
    )


async def start(daemon: Daemon, mission: Mission) -> "asyncio.Task[None]":
    """Start a mission as a client does that renews its lease for as long as the mission lasts."""
    mission_id = daemon.control.start(mission, LEASE_S)

    async def hold_on() -> None:
        with contextlib.suppress(RobotdError):
            while True:
                await asyncio.sleep(LEASE_S / 3)
                daemon.control.renew(mission_id)

    return asyncio.create_task(hold_on(), name="client")
