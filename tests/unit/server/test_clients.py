"""Both clients against a real server: every command, repeats, leases, and leaving early."""

import asyncio
import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import AbstractAsyncContextManager, aclosing
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robotd.client import AsyncClient, Client
from robotd.client.mission_run import MissionEvent
from robotd.contract.estimate import PoseState
from robotd.contract.events import MissionPhase, MissionProgress
from robotd.contract.missions import DriveStraight, DriveTo, Legs, Localize, Look, MapStart, Measure, Scan, Turn
from robotd.contract.topics import Frame
from robotd.core.errors import MissionError, RequestTimeout, ServerError, TransportError
from robotd.core.pose import IDENTITY, STANDSTILL, Odometry, Pose2
from tests.unit.server.conftest import stored_map

pytestmark = pytest.mark.real_clock
Serving = Callable[..., AbstractAsyncContextManager[Any]]


def phases(events: list[MissionEvent]) -> list[str]:
    return [event.phase for event in events if isinstance(event, MissionProgress)]


async def test_every_method_of_the_async_client(serving: Serving, tmp_path: Path) -> None:
    async with serving() as control, AsyncClient(tmp_path) as robot:
        assert (await robot.status()).bumpers_rad == (0.5,)
        assert "lease_s" in await robot.config()
        await robot.arm()
        assert control.armed
        assert phases(await robot.make_map("lab", ((1.0, 2.0),), Pose2(0.0, 1.0, 0.5), Legs.STRAIGHT))[-1] == "done"
        assert (await robot.localize(0.25, tie=False)).state is PoseState.LOCALIZED
        assert phases(await robot.drive_to(3.0, 4.0)) == ["started", "done"]
        assert phases(await robot.drive(0.5)) == phases(await robot.turn(-1.5)) == ["started", "done"]
        assert phases(await robot.look(0.5, -0.1)) == ["started", "done"]
        assert [one.range_m for one in await robot.measure(2)] == [1.5, 1.5]
        assert (await robot.scan(base_turns=False)).number == 3
        assert control.asked == [
            MapStart.of("lab", ((1.0, 2.0),), Pose2(0.0, 1.0, 0.5), Legs.STRAIGHT),
            Localize(0.25, tie=False),
            DriveTo(3.0, 4.0),
            DriveStraight(0.5),
            Turn(-1.5),
            Look(0.5, -0.1),
            Measure(2),
            Scan(base_turns=False),
        ]
        assert (await robot.map_save("lab")).name == "lab"
        assert (await robot.map_load("lab", 2, Pose2(1.0, 2.0, 0.0))).version == 2
        assert [entry.name for entry in await robot.map_list()] == ["office"]
        np.testing.assert_array_equal((await robot.map_show("office")).values, stored_map("office", None).values)
        assert await robot.record_start("there.mcap") == "there.mcap"
        assert (await robot.record_stop(), await robot.record_stop()) == ("there.mcap", None)
        await robot.disarm()
        await robot.stop("the end")
        assert control.calls[-2:] == ["stop: disarmed by request", "stop: the end"]
        with pytest.raises(ServerError, match="internal"):
            await robot.clear()


async def test_every_method_of_the_sync_client(serving: Serving, tmp_path: Path) -> None:
    def use() -> None:
        with Client(tmp_path) as robot:
            assert robot.hello().versions == (1,)
            assert robot.status().bumpers_rad == (0.5,)
            assert "lease_s" in robot.config()
            robot.arm()
            assert phases(robot.make_map("lab", ((1.0, 2.0),)))[-1] == "done"
            assert robot.localize(0.25, tie=False).state is PoseState.LOCALIZED
            assert phases(robot.drive_to(3.0, 4.0)) == ["started", "done"]
            assert phases(robot.drive(0.5)) == phases(robot.turn(-1.5)) == ["started", "done"]
            assert phases(robot.look(0.5, -0.1)) == ["started", "done"]
            assert [one.range_m for one in robot.measure(2)] == [1.5, 1.5]
            assert robot.scan().number == 3
            assert robot.map_save("lab").name == "lab"
            assert robot.map_load("lab", 2, Pose2(1.0, 2.0, 0.0)).version == 2
            assert [entry.name for entry in robot.map_list()] == ["office"]
            assert robot.map_show("office", 2).map_id == "office-2"
            assert robot.record_start() == "robot.mcap"
            assert (robot.record_stop(), robot.record_stop()) == ("robot.mcap", None)
            robot.disarm()
            robot.stop()
            with pytest.raises(ServerError, match="internal"):
                robot.clear()
            with robot.subscribe("status") as events:
                assert events.next(2) is not None
                assert events.next(0.05) is None

    async with serving() as control:
        await asyncio.to_thread(use)
        assert control.asked == [
            MapStart("lab", ((1.0, 2.0),)),
            Localize(0.25, tie=False),
            DriveTo(3.0, 4.0),
            DriveStraight(0.5),
            Turn(-1.5),
            Look(0.5, -0.1),
            Measure(2),
            Scan(),
        ]


@pytest.mark.parametrize("reason", ["x" * 50_000, "a\nb\x1b[2J", "half \ud800", "", str(ValueError("wheel"))])
async def test_a_client_can_stop_for_any_reason(serving: Serving, tmp_path: Path, reason: str) -> None:
    def use() -> None:
        with Client(tmp_path) as robot:
            robot.stop(reason)

    async with serving() as control, AsyncClient(tmp_path) as robot:
        await robot.arm()
        await robot.stop(reason)
        assert not control.armed
        await asyncio.to_thread(use)
        assert len(control.calls) == 3
        assert control.calls[1] == control.calls[2]
        assert control.calls[1].isprintable()
        assert len(control.calls[1]) > len("stop: ")


async def test_the_log_names_the_process_that_asked(
    serving: Serving, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level("INFO")
    async with serving(), AsyncClient(tmp_path) as robot:
        await robot.stop("enough")
    asked = next(message for message in caplog.messages if "enough" in message)
    assert asked.endswith(f"(uid {os.getuid()}, pid {os.getpid()}): stop reason=enough")


async def test_a_mission_is_told_from_its_start_to_its_end(serving: Serving, tmp_path: Path) -> None:
    async with serving() as control, AsyncClient(tmp_path) as robot:
        await robot.arm()
        for _ in range(2):
            names = [type(event).__name__ async for event in robot.run_mission(Localize())]
            assert names[0] == names[-1] == "MissionProgress"
            assert names[-4:-1] == ["SweepProgress", "PoseEstimate", "PoseEstimate"]
        assert control.mission_id == 2


async def test_leases_are_kept_alive_by_both_clients(serving: Serving, tmp_path: Path) -> None:
    def use() -> list[str]:
        with Client(tmp_path) as robot:
            return phases(list(robot.run_mission(Localize(), lease_s=0.25)))

    async with serving() as control, AsyncClient(tmp_path) as robot:
        await robot.arm()
        for run in (asyncio.to_thread(use), robot_phases(robot)):
            control.release.clear()
            asyncio.get_running_loop().call_later(0.6, control.release.set)
            assert await run == ["started", "done"]
        assert control.leases_s == [0.25, 0.25]


async def robot_phases(robot: AsyncClient) -> list[str]:
    return phases([event async for event in robot.run_mission(Localize(), lease_s=0.25)])


async def test_an_async_client_that_dawdles_over_an_event_keeps_its_lease(serving: Serving, tmp_path: Path) -> None:
    async with serving() as control, AsyncClient(tmp_path) as robot:
        await robot.arm()
        control.release.clear()
        async with aclosing(robot.run_mission(Localize(), lease_s=0.25)) as events:
            await anext(events)
            await asyncio.sleep(0.6)
            control.release.set()
            assert phases([event async for event in events]) == ["done"]


async def test_frames_are_handed_on_as_they_are(serving: Serving, tmp_path: Path) -> None:
    async with serving() as control, AsyncClient(tmp_path) as robot:
        control.events.publish(Odometry(1, IDENTITY, STANDSTILL))
        heard: list[Frame] = []
        async with asyncio.timeout(60.0), aclosing(robot.frames("odometry", "status", "map")) as frames:
            async for frame in frames:
                assert isinstance(frame, Frame)
                if frame.event not in {one.event for one in heard}:
                    heard.append(frame)
                if len(heard) == 3:
                    break
    assert {one.event for one in heard} == {"odometry", "status", "map_changed"}
    for one in heard:
        assert one.data.startswith(f"{one.topic}\0".encode())
        assert Frame.of(one.data) == one


async def test_a_mission_whose_client_falls_silent_is_stopped(serving: Serving, tmp_path: Path) -> None:
    async with serving() as control, AsyncClient(tmp_path) as robot:
        await robot.arm()
        control.release.clear()
        with robot.subscribe("mission") as events:
            await robot.start(Localize(), lease_s=0.1)
            last = None
            while not (isinstance(last, MissionProgress) and last.is_last):
                last = await events.next(2)
                assert last is not None
        assert (last.phase, last.message) == (MissionPhase.STOPPED, "lease expired")


async def test_a_mission_stopped_by_another_client_ends_with_the_reason(serving: Serving, tmp_path: Path) -> None:
    async with serving() as control, AsyncClient(tmp_path) as robot, AsyncClient(tmp_path) as other:
        await robot.arm()
        control.release.clear()
        localizing = asyncio.create_task(robot.localize())
        await control.begun.wait()
        await other.stop("a child in the way")
        with pytest.raises(MissionError, match="stopped: a child in the way"):
            await localizing


async def test_leaving_an_async_mission_early_stops_the_robot(serving: Serving, tmp_path: Path) -> None:
    async with serving() as control, AsyncClient(tmp_path) as robot:
        await robot.arm()
        control.release.clear()
        async with aclosing(robot.run_mission(Localize())) as events:
            await anext(events)
        assert control.calls[-1].startswith("stop: client")
        control.begun.clear()
        await robot.arm()
        task = asyncio.create_task(robot.localize())
        await control.begun.wait()
        task.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await task
        assert [call.split(":")[0] for call in control.calls] == ["arm", "start", "stop"] * 2


async def test_leaving_a_sync_mission_early_stops_the_robot(serving: Serving, tmp_path: Path) -> None:
    def use() -> None:
        with Client(tmp_path) as robot:
            robot.arm()
            for _ in robot.run_mission(Localize()):
                break

    async with serving() as control:
        control.release.clear()
        await asyncio.to_thread(use)
        assert [call.split(":")[0] for call in control.calls] == ["arm", "start", "stop"]


async def test_ctrl_c_stops_the_robot_first(serving: Serving, tmp_path: Path) -> None:
    script = (
        "import sys\n"
        "from robotd.client import Client\n"
        "with Client(sys.argv[1]) as robot:\n"
        "    robot.arm()\n"
        "    robot.localize()\n"
    )
    async with serving() as control:
        control.release.clear()
        child = await asyncio.create_subprocess_exec(
            sys.executable, "-c", script, str(tmp_path), stderr=subprocess.PIPE, stdin=subprocess.DEVNULL
        )
        await control.begun.wait()
        child.send_signal(signal.SIGINT)
        _, errors = await child.communicate()
        assert b"KeyboardInterrupt" in errors
        assert control.calls[-1] == f"stop: client {child.pid} left its mission"


async def test_two_clients_do_not_mix_their_answers(serving: Serving, tmp_path: Path) -> None:
    async def save(client: AsyncClient, name: str) -> None:
        for number in range(20):
            assert (await client.map_save(f"{name}{number}")).name == f"{name}{number}"

    async with serving(), AsyncClient(tmp_path) as one, AsyncClient(tmp_path) as two:
        await asyncio.gather(save(one, "a"), save(one, "b"), save(two, "c"), save(two, "d"))


async def test_a_repeated_request_is_carried_out_once(serving: Serving, tmp_path: Path) -> None:
    async with serving() as control, AsyncClient(tmp_path, retry_s=0.05) as robot:
        control.arming.clear()
        asyncio.get_running_loop().call_later(0.3, control.arming.set)
        await robot.arm()
        assert control.calls == ["arm"]


async def test_nobody_home_is_a_timeout_and_an_old_request_is_not_left_behind(serving: Serving, tmp_path: Path) -> None:
    async with AsyncClient(tmp_path, retry_s=0.05, deadline_s=0.15) as robot:
        with pytest.raises(RequestTimeout, match="arm: no answer"):
            await robot.arm()
        async with serving() as control:
            await asyncio.sleep(0.3)
            assert control.calls == []
            assert (await robot.status()).reason == "fake"


def test_nobody_home_is_a_timeout_for_the_sync_client_too(tmp_path: Path) -> None:
    before_s = time.monotonic()
    with Client(tmp_path, retry_s=0.05, deadline_s=0.15) as robot:
        with pytest.raises(RequestTimeout, match="status: no answer"):
            robot.status()
        with pytest.raises(RequestTimeout, match="hello: no answer"):
            robot.localize()
    assert time.monotonic() - before_s < 2


async def test_a_daemon_that_dies_in_a_mission_is_noticed(serving: Serving, tmp_path: Path) -> None:
    async with AsyncClient(tmp_path, retry_s=0.05, deadline_s=0.3) as robot:
        async with serving() as control:
            await robot.arm()
            control.release.clear()
            events = robot.run_mission(Localize())
            await anext(events)
        with pytest.raises(RequestTimeout, match="renew"):
            async for _ in events:
                pass


async def test_a_refusal_of_a_mission_is_raised(serving: Serving, tmp_path: Path) -> None:
    async with serving(), AsyncClient(tmp_path) as robot:
        with pytest.raises(ServerError, match="not now") as caught:
            await robot.localize()
        assert caught.value.code == "refused"


async def test_the_runtime_directory_comes_from_the_environment(
    serving: Serving, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROBOTD_RUNTIME_DIR", str(tmp_path))
    async with serving(), AsyncClient() as robot:
        assert (await robot.hello()).versions == (1,)


def test_a_path_too_long_for_a_socket_is_refused(tmp_path: Path) -> None:
    with pytest.raises(TransportError, match="107"):
        Client(tmp_path / ("x" * 100))
