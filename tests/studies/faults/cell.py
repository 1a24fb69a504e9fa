"""One cell of the matrix: this fault, on that cable, while the daemon is at this; and what must be true of it."""

import asyncio
import random
import tempfile
import tracemalloc
from dataclasses import dataclass
from pathlib import Path

from firmware_proto.common import BoardState
from robotd.contract.modes import Mode
from robotd.contract.requests import Arm, Clear, MapLoad, MapSave, Stop
from robotd.core.clock import NS_PER_S, now_ns, run_virtual
from robotd.core.errors import RobotdError
from robotd.recording.reader import read
from robotd.sim.emulators.catalogue import OWN, Dialects
from robotd.sim.faults.fault_words import FAULTS
from robotd.sim.hosting.host import OwnBoard
from tests.support.bench import Bench, bench
from tests.support.living import until_ready
from tests.support.states import STATES

NOTICED_WITHIN_S = 1.1
"""A line may be silent for a second before it counts as lost."""
VENDOR_NOTICED_WITHIN_S = 3.1
"""Vendor devices speak when asked: they are asked after a second, and for another one at least."""
REST_AFTER_STOP_S = 0.8
"""The ramp from cruising speed."""
READY_AGAIN_S = 10.0
MEMORY_BYTES = 2_000_000
"""What a daemon may hold more, at any moment of a flood, than before it."""
BEARABLE = frozenset({"bitflips", "drop", "double", "split", "flood", "blocked", "drip"})
"""With these the robot may go on with its work, as damaged bytes are data; all others must stop it."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a cell."""

    fault: str
    state: str
    device: str
    stop_s: float | None
    """From the fault to the first stop on a wire; None: it went on with its work."""
    rest_s: float
    """From the fault to the last motion; where it may go on with its work, from the stop."""
    failures: tuple[str, ...]


def run_cell(fault: str, state: str, device: str, seed: int = 1, dialects: Dialects | None = None) -> Outcome:
    """Run one cell on the virtual clock."""
    with tempfile.TemporaryDirectory(prefix="robotd-faults-") as directory:
        dialects = dialects or Dialects()
        noticed_s = NOTICED_WITHIN_S if getattr(dialects, device) == OWN else VENDOR_NOTICED_WITHIN_S
        return run_virtual(_Cell(fault, state, device, seed, noticed_s).run(Path(directory), dialects))


class _Cell:
    def __init__(self, fault: str, state: str, device: str, seed: int, noticed_s: float) -> None:
        self._fault = fault
        self._state = state
        self._device = device
        self._rng = random.Random(f"{seed}/{fault}/{state}/{device}")
        self._noticed_s = noticed_s
        self._failures: list[str] = []

    async def run(self, directory: Path, dialects: Dialects) -> Outcome:
        stop_s, rest_s = None, 0.0
        try:
            async with bench(directory, dialects) as it:
                await STATES[self._state](it)
                stop_s, rest_s = await self._while_it_lasts(it)
                await self._afterwards(it)
            self._check_recording(directory)
        except (RobotdError, TimeoutError, AssertionError) as error:
            self._failures.append(f"{type(error).__name__}: {error}")
        return Outcome(self._fault, self._state, self._device, stop_s, rest_s, tuple(self._failures))

    def _check(self, is_so: bool, otherwise: str) -> None:
        if not is_so:
            self._failures.append(otherwise)

    async def _while_it_lasts(self, it: Bench) -> tuple[float | None, float]:
        began_ns, may_move = now_ns(), _may_move(it)
        if self._fault == "flood":
            tracemalloc.start()
        it.cables[self._device].set_fault(FAULTS[self._fault](self._rng))
        await asyncio.sleep(self._noticed_s + REST_AFTER_STOP_S + 1.0)
        self._check_memory()
        stop_s = it.stops.first_after(began_ns) if may_move and not _may_move(it) else None
        since_ns, bound_s = began_ns, self._noticed_s + REST_AFTER_STOP_S
        if may_move and self._fault in BEARABLE:
            since_ns, bound_s = await self._stop_at_last(it, began_ns, stop_s), REST_AFTER_STOP_S
        elif may_move:
            self._check(stop_s is not None and stop_s <= self._noticed_s, f"stop after {stop_s} s")
        rest_s = max(0.0, (it.moved_ns - since_ns) / NS_PER_S)
        self._check(not it.is_moving, "it moves")
        self._check(rest_s <= bound_s, f"at rest after {rest_s:.3f} s")
        return stop_s, rest_s

    async def _stop_at_last(self, it: Bench, began_ns: int, stop_s: float | None) -> int:
        """Return when it stopped by itself, or stop it as a client does, while the fault lasts."""
        stopped_ns = now_ns() if stop_s is None else began_ns + round(stop_s * NS_PER_S)
        if stop_s is None:
            await it.daemon.control.perform(Stop("enough"))
        await asyncio.sleep(self._noticed_s + REST_AFTER_STOP_S)
        return stopped_ns

    def _check_memory(self) -> None:
        if not tracemalloc.is_tracing():
            return
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        self._check(peak <= MEMORY_BYTES, f"{peak} bytes more in memory")

    async def _afterwards(self, it: Bench) -> None:
        """Let the fault end: everything comes back, and nothing moves before it is armed."""
        it.cables[self._device].mend()
        where, moved_ns = it.robot.truth, it.moved_ns
        async with asyncio.timeout(READY_AGAIN_S):
            await until_ready(it.daemon)
        await asyncio.sleep(2.0)
        self._check(it.is_alive, "a part of the daemon ended")
        self._check(it.robot.truth == where and it.moved_ns == moved_ns, "it moved without being armed")
        states = {name: board.state for name, board in it.robot.boards.items() if isinstance(board, OwnBoard)}
        self._check(BoardState.ARMED not in states.values(), f"something is armed: {states}")
        self._check(not any(one.status.armed for one in it.daemon.robot.devices), "something is believed to be armed")
        await self._check_map(it)
        await self._check_arming(it)

    async def _check_map(self, it: Bench) -> None:
        """Nothing that was on the map is lost, and it can be saved."""
        place = it.daemon.supervisor.whereabouts.map_in_use
        if place is None:
            return
        if self._state.startswith("map"):
            self._check(place.generation >= 1, "the map so far is gone")
        digest = place.digest
        entry = await it.daemon.control.perform(MapSave("kept"))
        await it.daemon.control.perform(MapLoad.of(entry.name, None, None))
        self._check(it.daemon.supervisor.whereabouts.map_in_use is not place, "the saved map did not come into use")
        loaded = it.daemon.supervisor.whereabouts.map_in_use
        self._check(loaded is not None and loaded.digest == digest, "the saved map is another one")

    async def _check_arming(self, it: Bench) -> None:
        if it.mode is Mode.FAULT:
            await it.daemon.control.perform(Clear())
        self._check(it.mode is Mode.DISARMED, f"it is {it.mode}")
        await it.daemon.control.perform(Arm())
        await asyncio.sleep(0.2)
        self._check(it.mode is Mode.IDLE, f"armed, it is {it.mode}: {it.daemon.control.status.reason}")

    def _check_recording(self, directory: Path) -> None:
        (file,) = (directory / "recordings").glob("*.mcap")
        recording = read(file)
        self._check(recording.complete and len(recording.entries) > 100, "the recording is damaged")


def _may_move(it: Bench) -> bool:
    return it.mode not in {Mode.DISARMED, Mode.FAULT}
