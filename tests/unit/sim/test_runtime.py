import asyncio
import contextlib
import json
import math
import random
from collections.abc import AsyncIterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from firmware_proto.common import Hello, HelloReply
from firmware_proto.framing import Deframer, RawFrame, encode_frame
from robotd.contract.device_status import LinkState
from robotd.core.clock import run_virtual
from robotd.core.errors import TransportError
from robotd.core.pose import Pose2, Twist2
from robotd.core.reading import ReadingStatus
from robotd.hardware.devices.board_drive import BoardDrive
from robotd.hardware.devices.board_pantilt import BoardPanTilt
from robotd.hardware.devices.board_rangefinder import BoardRangefinder
from robotd.hardware.devices.device import Device
from robotd.hardware.devices.dialect_options import BoardDriveSettings, BoardPanTiltSettings, BoardRangefinderSettings
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.transport.line_format import LineFormat
from robotd.hardware.transport.serial_port import open_serial
from robotd.hardware.transport.transport import Connect, Transport
from robotd.sim.buildings.world import load_world
from robotd.sim.physics.noise import NOISELESS
from robotd.sim.robot import EmulatedRobot, SimSettings, SimulatedRobot
from robotd.sim.runtime import connectors, run_on_ptys
from tests.support.own_boards import own_board
from tests.support.taps import NoTap


def office_robot(seed: int = 1) -> SimulatedRobot:
    return SimulatedRobot(load_world("office"), seed)


def ideal_robot() -> SimulatedRobot:
    return SimulatedRobot(load_world("office"), 1, SimSettings(noise=NOISELESS))


@dataclass
class Daemon:
    """The daemon's side: the three devices in SI units, armed."""

    drive: BoardDrive
    pantilt: BoardPanTilt
    rangefinder: BoardRangefinder

    async def go(self, twist: Twist2, seconds: float) -> None:
        """Hold a velocity, as leased motion is held, and stand."""
        for command, tenths in ((twist, round(seconds * 10)), (Twist2(0.0, 0.0), 20)):
            for _ in range(tenths):
                self.drive.set_velocity(command, 0.4)
                await asyncio.sleep(0.1)


@contextlib.asynccontextmanager
async def armed(connect: dict[str, Connect]) -> AsyncIterator[Daemon]:
    def wiring(device: str) -> Wiring:
        return Wiring(connect[device], NoTap(), random.Random(1))

    daemon = Daemon(
        BoardDrive(BoardDriveSettings(), wiring("drive")),
        BoardPanTilt(BoardPanTiltSettings(), wiring("pantilt")),
        BoardRangefinder(BoardRangefinderSettings(), wiring("rangefinder")),
    )
    devices: list[Device] = [daemon.drive, daemon.pantilt, daemon.rangefinder]
    tasks = [asyncio.create_task(device.run()) for device in devices]
    try:
        for device in devices:
            with device.status_changes.subscribe() as changes:
                while device.status.link is not LinkState.READY:
                    await changes.get()
            await device.arm()
        yield daemon
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


async def test_the_daemons_devices_drive_aim_and_measure() -> None:
    robot = ideal_robot()
    async with connectors(robot) as connect, armed(connect) as daemon:
        await daemon.go(Twist2(0.3, 0.0), 3.0)
        odometry = daemon.drive.odometry.latest
        assert odometry is not None
        driven = robot.start @ odometry.in_odom
        assert driven.x_m > 1.7
        assert driven.distance_m(robot.truth) < 1e-3
        await daemon.rangefinder.switch_laser(on=True)
        aim = await daemon.pantilt.aim(-math.pi / 2, 0.0, timeout_s=2.0)
        shot = await daemon.rangefinder.shoot(timeout_s=1.0)
        assert shot.status is ReadingStatus.OK
        assert shot.range_m == pytest.approx(robot.truth.y_m / -math.sin(aim.pan_rad), abs=0.002)


def test_two_robots_of_one_seed_live_the_same_life() -> None:
    async def life(seed: int) -> list[tuple[Pose2, float | None]]:
        robot = office_robot(seed)
        async with connectors(robot) as connect, armed(connect) as daemon:
            await daemon.rangefinder.switch_laser(on=True)
            lived = []
            for _ in range(4):
                await daemon.go(Twist2(0.2, 0.4), 0.8)
                lived.append((robot.truth, (await daemon.rangefinder.shoot(timeout_s=1.0)).range_m))
            return lived

    first, again, other = run_virtual(life(7)), run_virtual(life(7)), run_virtual(life(8))
    assert first == again
    assert first != other


def test_what_one_device_does_leaves_the_noise_of_the_others_alone() -> None:
    async def truth(shots: int) -> Pose2:
        robot = office_robot()
        async with connectors(robot) as connect, armed(connect) as daemon:
            await daemon.rangefinder.switch_laser(on=True)
            started_s = asyncio.get_running_loop().time()
            for _ in range(shots):
                await daemon.rangefinder.shoot(timeout_s=1.0)
            await asyncio.sleep(started_s + 5.0 - asyncio.get_running_loop().time())
            await daemon.go(Twist2(0.3, 0.1), 2.0)
            return robot.truth

    assert run_virtual(truth(0)) == run_virtual(truth(9))


async def test_a_board_goes_on_living_while_it_is_unplugged() -> None:
    robot = ideal_robot()
    async with connectors(robot) as connect:
        async with armed(connect) as daemon:
            daemon.drive.set_velocity(Twist2(0.3, 0.0), 0.4)
            await asyncio.sleep(0.1)
        was_moving = not robot.at_rest
        await asyncio.sleep(2.0)
        assert was_moving
        assert robot.at_rest  # the deadman was the board's own
        assert 0.0 < robot.truth.x_m - robot.start.x_m < 0.3
        line = await connect["drive"]()
        assert await hello(line) == await hello(line)
        line.close()


async def test_the_truth_is_written_whenever_the_robot_has_come_to_rest(tmp_path: Path) -> None:
    path = tmp_path / "truth.jsonl"
    robot = office_robot()
    async with connectors(robot, truth_path=path) as connect, armed(connect) as daemon:
        await daemon.go(Twist2(0.3, 0.0), 1.0)
        await daemon.go(Twist2(0.0, 0.5), 1.0)
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    assert len(lines) == 3
    assert [set(line) for line in lines] == [{"t_ns", "x_m", "y_m", "heading_rad"}] * 3
    assert (lines[0]["x_m"], lines[0]["y_m"]) == (robot.start.x_m, robot.start.y_m)
    assert lines[2]["heading_rad"] == robot.truth.heading_rad
    assert lines[0]["t_ns"] < lines[1]["t_ns"] < lines[2]["t_ns"]


async def test_a_board_that_breaks_is_not_kept_silent() -> None:
    robot = office_robot()

    def broken(now_us: int) -> None:
        raise RuntimeError("on fire")

    own_board(robot, "drive").advance = broken  # type: ignore[method-assign]  # that is the point
    with pytest.raises(RuntimeError, match="on fire"):
        async with connectors(robot):
            await asyncio.sleep(1.0)


async def hello(line: Transport) -> int:
    """Say HELLO and return the boot id."""
    line.write(encode_frame(RawFrame(Hello.TYPE, 1, Hello(1, 0, 5).to_payload())))
    deframer = Deframer()
    async with asyncio.timeout(60.0):
        while True:
            for frame in deframer.feed(await line.read()):
                if frame.type == HelloReply.TYPE:
                    return HelloReply.from_payload(frame.payload).boot_id


@contextlib.asynccontextmanager
async def on_ptys(robot: EmulatedRobot, directory: Path) -> AsyncIterator[dict[str, str]]:
    announced: asyncio.Future[dict[str, str]] = asyncio.get_running_loop().create_future()
    task = asyncio.create_task(run_on_ptys(robot, announce=announced.set_result, directory=directory))
    try:
        async with asyncio.timeout(60.0):
            yield await announced
    finally:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


@pytest.mark.real_clock
async def test_programs_may_open_the_ptys_again_and_again(tmp_path: Path) -> None:
    robot = office_robot()
    async with on_ptys(robot, tmp_path / "dev") as paths:
        assert paths == {device: str(tmp_path / "dev" / device) for device in robot.boards}
        boot_ids = set()
        for device, path in [*paths.items(), *paths.items()]:
            line = await open_serial(path, LineFormat(115_200))
            boot_ids.add((device, await hello(line)))
            line.close()
        assert len(boot_ids) == 3
    assert not list((tmp_path / "dev").iterdir())


@pytest.mark.real_clock
async def test_links_of_an_earlier_run_are_replaced_and_other_files_are_not(tmp_path: Path) -> None:
    (tmp_path / "drive").symlink_to("/dev/null")
    async with on_ptys(office_robot(), tmp_path):
        assert str((tmp_path / "drive").readlink()).startswith("/dev/pts/")
    (tmp_path / "pantilt").write_text("mine")
    with pytest.raises(TransportError, match="cannot link"):
        await run_on_ptys(office_robot(), announce=lambda paths: None, directory=tmp_path)
    assert (tmp_path / "pantilt").read_text() == "mine"
    assert not (tmp_path / "drive").is_symlink()
