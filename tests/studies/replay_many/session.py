"""One random session: a client's commands, cables that fail, clients that die, stalls; recorded, and replayed."""

import asyncio
import contextlib
import random
import tempfile
from collections.abc import Callable, Coroutine
from pathlib import Path
from typing import Any

from robotd.app.replaying import replay_recording
from robotd.app.stall_guard import LATE_S, STALL_S
from robotd.contract.events import MissionProgress
from robotd.contract.missions import DriveTo, Legs, Localize, MapStart, Mission
from robotd.contract.modes import Mode
from robotd.contract.requests import Arm, Clear, RecordStop, Stop
from robotd.core.clock import now_ns, run_virtual
from robotd.core.errors import RobotdError
from robotd.mission.safety.hold import Stall
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.faults.fault import Fault
from robotd.sim.faults.fault_words import FAULTS
from robotd.sim.robot import DEVICES
from tests.studies.replay_many.outcome import Outcome, difference
from tests.studies.replay_many.weather import Rechunked, Slowly, block
from tests.support.bench import Bench, bench

_LEASE_S = 0.5
_PAUSE_MAX_S = 2.0
_FEW_MS = 0.003
_FAULT_MAX_S = 3.0
VENDOR_ROBOTS = (
    Dialects("rwi-ascii", "ptu", "dimetix"),
    Dialects("rflex", "dynamixel", "tfmini-s"),
    Dialects("board", "fixed", "scip"),
    Dialects("rwi-ascii", "dynamixel", "lw20"),
    Dialects("rflex", "ptu", "lwnx"),
    Dialects("board", "board", "disto"),
)
_MAPS_FIRST = 0.5
"""Share of the sessions that begin with a map."""


def run_session(seed: int, actions: int, dialects: Dialects | None = None) -> Outcome:
    """Live through a session of a robot (with our own boards, if none is said) on the virtual clock, and replay it."""
    with tempfile.TemporaryDirectory(prefix="robotd-replays-") as directory:
        session = _Session(random.Random(f"session {seed}"), dialects or Dialects())
        run_virtual(session.run(Path(directory), actions))
        (file,) = (Path(directory) / "recordings").glob("*.mcap")
        report = replay_recording(file)
    return Outcome(seed, tuple(session.done), difference(report), report.results)


class _Session:
    def __init__(self, rng: random.Random, dialects: Dialects) -> None:
        self._rng = rng
        self._dialects = dialects
        self.done: list[str] = []
        self._calm: type[Fault] = Fault
        """What a cable has while nothing is wrong with it."""

    async def run(self, directory: Path, actions: int) -> None:
        worker = self._rng.choice((None, Slowly(self._rng)))
        async with bench(directory, self._dialects, worker=worker) as it:  # type: ignore[arg-type]  # as it is there
            self._calm = self._rng.choice((Fault, Rechunked))
            self._calm_down(it)
            if self._rng.random() < _MAPS_FIRST:
                await self._make_a_map(it)
            for _ in range(actions):
                await asyncio.sleep(
                    self._rng.choice((self._rng.uniform(0, _FEW_MS), self._rng.uniform(0, _PAUSE_MAX_S)))
                )
                await self._act(it)
            self._calm_down(it)
            await asyncio.sleep(0.2)
            await it.daemon.control.perform(RecordStop())  # before the lines are taken down

    def _calm_down(self, it: Bench) -> None:
        for cable in it.cables.values():
            cable.set_fault(self._calm(self._rng))

    async def _act(self, it: Bench) -> None:
        name, act = self._rng.choice(tuple(self._acts(it).items()))
        self.done.append(name)
        try:
            await act()
        except RobotdError as error:  # refused, as happens to clients
            self.done.append(f"({error})")

    def _acts(self, it: Bench) -> dict[str, Callable[[], Coroutine[Any, Any, object]]]:
        return {
            "arm": lambda: it.daemon.control.perform(Arm()),
            "arm again": lambda: self._bring_back(it),
            "map": lambda: self._start(it, MapStart.of("new", it.robot.stops_m, it.robot.start, Legs.STRAIGHT)),
            "localize": lambda: self._start(it, Localize()),
            "drive": lambda: self._start(it, DriveTo(*it.robot.stops_m[0], Legs.STRAIGHT)),
            "map and die": lambda: self._start_and_die(it),
            "stop": lambda: it.daemon.control.perform(Stop("enough")),
            "clear": lambda: it.daemon.control.perform(Clear()),
            "stall": lambda: self._stall(it),
            "block": lambda: self._block(it),
            "fault": lambda: self._fault(it),
            "fault and stop": lambda: self._fault_and_stop(it),
            "arm and stop": lambda: self._arm_and_stop(it),
            "stop with bytes": lambda: self._with_bytes(it, lambda: it.daemon.control.perform(Stop("enough"))),
            "arm with bytes": lambda: self._with_bytes(it, lambda: it.daemon.control.perform(Arm())),
        }

    async def _bring_back(self, it: Bench) -> None:
        if it.mode is Mode.FAULT:
            await it.daemon.control.perform(Clear())
        await it.daemon.control.perform(Arm())

    async def _start(self, it: Bench, mission: Mission) -> None:
        it.start(mission)

    async def _start_and_die(self, it: Bench) -> None:
        it.daemon.control.start(MapStart.of("new", it.robot.stops_m, it.robot.start, Legs.STRAIGHT), _LEASE_S)

    async def _stall(self, it: Bench) -> None:
        was_driven = it.daemon.robot.drive.is_driven
        if was_driven:
            it.daemon.robot.stop_past_loop()  # as the guard's thread does
        it.daemon.causes.stalled(Stall(now_ns(), STALL_S, was_driven, "the log"))

    async def _block(self, it: Bench) -> None:
        """Let the loop stand still, often for less than is noticed."""
        stood_still_s = self._rng.choice((self._rng.uniform(0.0, LATE_S), self._rng.uniform(0.0, 3 * STALL_S)))
        was_driven = it.daemon.robot.drive.is_driven and stood_still_s > STALL_S
        if was_driven:
            it.daemon.robot.stop_past_loop()  # as the guard's thread does
        block(stood_still_s)
        if stood_still_s >= LATE_S:
            it.daemon.causes.stalled(Stall(now_ns(), stood_still_s, was_driven, "the log"))

    async def _fault(self, it: Bench) -> None:
        device, fault = self._rng.choice(DEVICES), self._rng.choice(tuple(FAULTS))
        self.done.append(f"{fault} on {device}")
        it.cables[device].set_fault(FAULTS[fault](self._rng))
        await asyncio.sleep(self._rng.uniform(0, _FAULT_MAX_S))
        it.cables[device].set_fault(self._calm(self._rng))

    async def _arm_and_stop(self, it: Bench) -> None:
        """Let a stop come some turns of the loop after arming began, before or after it is answered."""
        arming = asyncio.create_task(self._bring_back(it))
        await self._some_turns(30)
        await it.daemon.control.perform(Stop("enough"))
        await arming

    async def _with_bytes(self, it: Bench, ask: Callable[[], Coroutine[Any, Any, object]]) -> None:
        """Let a request come within some turns of the loop of a line's bytes."""
        with it.daemon.robot.drive.odometry.subscribe() as odometry, contextlib.suppress(TimeoutError):
            async with asyncio.timeout(_PAUSE_MAX_S):  # its line may be down
                await odometry.get()
        await self._some_turns(5)
        await ask()

    async def _some_turns(self, most: int) -> None:
        for _ in range(self._rng.randrange(most)):
            await asyncio.sleep(0)

    async def _make_a_map(self, it: Bench) -> None:
        """Make a map of one stop, so that localizing and driving are not merely refused."""
        self.done.append("make a map")
        await it.daemon.control.perform(Arm())
        it.start(MapStart.of("first", (), it.robot.start, Legs.STRAIGHT))
        await it.until(lambda event: isinstance(event, MissionProgress) and event.is_last)

    async def _fault_and_stop(self, it: Bench) -> None:
        """Let a line be lost and a stop come within two milliseconds, in either order."""
        cable = it.cables[self._rng.choice(DEVICES)]
        cable.set_fault(FAULTS["unplug"](self._rng))
        await asyncio.sleep(self._rng.uniform(0, 0.002))
        await it.daemon.control.perform(Stop("enough"))
        await asyncio.sleep(self._rng.uniform(0, _FAULT_MAX_S))
        cable.set_fault(self._calm(self._rng))
