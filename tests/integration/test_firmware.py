"""The daemon drives boards whose firmware is C exactly as it drives the emulated ones."""

import asyncio
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from firmware_proto.common import BoardState, Fault, Hello, HelloReply
from firmware_proto.framing import Deframer
from robotd.config import Config
from robotd.contract.device_status import LinkState
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.missions import Localize, MapStart
from robotd.core.clock import now_ns, run_virtual
from robotd.core.pose import Pose2
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.sim.buildings.world import load_world
from robotd.sim.emulators.catalogue import Dialects, Firmware
from robotd.sim.faults.laid import cables
from robotd.sim.hosting.host import HostedBoard
from robotd.sim.robot import SimulatedRobot
from tests.integration.conftest import Live
from tests.support.living import living, until_ready

pytestmark = pytest.mark.skipif(
    find_spec("robotd.sim.firmware._native") is None, reason="there was no C compiler for the firmware"
)

Heard = tuple[int, int, int, bytes]
"""When it passed, in the host's time; type, seq and payload of a frame."""


class Tapped:
    """A board whose line is listened to."""

    def __init__(self, board: HostedBoard) -> None:
        self.board = board
        self.frames: list[Heard] = []
        self._ears = Deframer(), Deframer()

    @property
    def next_event_us(self) -> int | None:
        return self.board.next_event_us

    def receive(self, data: bytes, now_us: int) -> None:
        self._note(self._ears[0], data)
        self.board.receive(data, now_us)

    def advance(self, now_us: int) -> None:
        self.board.advance(now_us)

    def take_output(self) -> bytes:
        said = self.board.take_output()
        self._note(self._ears[1], said)
        return said

    def _note(self, ear: Deframer, data: bytes) -> None:
        """Note frames, but for the number that a host draws at random for each session."""
        drawn = {Hello.TYPE: slice(2, 6), HelloReply.TYPE: slice(2, 6)}
        for frame in ear.feed(data):
            payload = bytearray(frame.payload)
            if frame.type in drawn:
                payload[drawn[frame.type]] = bytes(4)
            self.frames.append((now_ns(), frame.type, frame.seq, bytes(payload)))


async def mission(directory: Path, firmware: Firmware) -> tuple[dict[str, list[Heard]], Pose2]:
    """Map a room and find the robot in it; return what passed on each line, and where the robot really ended."""
    world = load_world("office")
    robot = SimulatedRobot(world, seed=2, dialects=Dialects(boards=firmware))
    taps = {device: Tapped(board) for device, board in robot.boards.items()}
    robot.boards.update(taps)
    async with living(directory, robot, Config(sweep=SweepSettings(readings=150))) as it:
        await it.done(MapStart.of("office", world.stops_m[:1], world.start_pose))
        said = await it.done(Localize())
        estimate = [event for event in said if isinstance(event, PoseEstimate) and event.final][-1]
        assert estimate.state is PoseState.LOCALIZED, estimate
    return {device: tap.frames for device, tap in taps.items()}, robot.truth


@pytest.mark.slow
def test_a_whole_mission_is_the_same_frame_for_frame(tmp_path: Path) -> None:
    """Everything: handshake, dictionary, clock, sweeps, shots, drives, every report and when it was made."""
    emulated, emulated_end = run_virtual(mission(tmp_path / "emulated", Firmware.PYTHON))
    in_c, in_c_end = run_virtual(mission(tmp_path / "c", Firmware.C))
    assert in_c_end == emulated_end
    for device, frames in emulated.items():
        assert len(frames) > 1000
        assert in_c[device] == frames


async def test_a_board_that_loses_power_is_noticed_and_stays_disarmed(live: Live) -> None:
    robot = SimulatedRobot(load_world("office"), seed=2, dialects=Dialects(boards=Firmware.C))
    board: Any = robot.boards["drive"]
    async with live(robot) as it:
        assert board.state == BoardState.ARMED
        board.reboot(4711)
        assert (board.state, board.faults) == (BoardState.BOOT, Fault.NONE)
        async with asyncio.timeout(10.0):
            with it.daemon.robot.drive.status_changes.subscribe() as changes:
                while (await changes.get()).link is not LinkState.ABSENT:
                    pass
        await until_ready(it.daemon)
        assert board.state == BoardState.CONFIGURED


async def test_faults_can_take_the_power_of_boards_in_c_and_of_no_vendor_device() -> None:
    dialects = Dialects(pantilt="ptu", boards=Firmware.C)
    async with cables(SimulatedRobot(load_world("office"), seed=2, dialects=dialects)) as laid:
        assert {device: cable.can_reboot for device, cable in laid.items()} == {
            "drive": True,
            "pantilt": False,
            "rangefinder": True,
        }
        laid["drive"].reboot()
