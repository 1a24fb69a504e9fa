"""What the robot still does when a part of it does not, and how it says so."""

import asyncio
from dataclasses import replace
from pathlib import Path

import pytest

from firmware_proto.rangefinder_messages import ShotStatus
from robotd.app.compose import Daemon, compose
from robotd.app.daemon import new_journal
from robotd.config import Config
from robotd.contract.device_status import LinkState
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import Event, MissionPhase, MissionProgress, SweepProgress
from robotd.contract.missions import Localize, MapStart
from robotd.contract.modes import Mode
from robotd.contract.requests import Arm, Clear, Stop
from robotd.core.errors import MissionError
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.sim.boards.rangefinder_board import RangefinderBoard
from robotd.sim.buildings.world import load_world
from robotd.sim.emulators.catalogue import Dialects
from robotd.sim.emulators.emulated_ptu import PtuEmulator
from robotd.sim.faults.laid import cables
from robotd.sim.physics.plant import ShotAnswer
from robotd.sim.robot import SimulatedRobot
from tests.integration.conftest import Live
from tests.integration.test_dialects import config_for
from tests.support.living import AtOnce, Living, in_directory, until_ready
from tests.support.own_boards import own_board
from tests.support.places import head_on, unpaced

QUICK = replace(Config(), sweep=SweepSettings(readings=120))


def office(dialects: Dialects | None = None) -> SimulatedRobot:
    return SimulatedRobot(load_world("office"), seed=5, dialects=dialects)


def spoil(robot: SimulatedRobot, good: int, of: int) -> RangefinderBoard:
    """Let the instrument find the light too weak but for ``good`` of each ``of`` shots, from the 11th on."""
    board = own_board(robot, "rangefinder")
    assert isinstance(board, RangefinderBoard)
    shoot, taken = board._plant.shoot, 0

    def weakly(at_us: int) -> ShotAnswer:
        nonlocal taken
        taken += 1
        answer = shoot(at_us)
        return answer if taken <= 10 or taken % of < good else ShotAnswer(ShotStatus.WEAK, 0.0, 1, answer.takes_us)

    board._plant.shoot = weakly  # type: ignore[method-assign]  # a lens that mists over
    return board


def messages(said: list[Event]) -> list[str]:
    return [event.message for event in said if isinstance(event, MissionProgress) and event.message]


async def test_a_weak_rangefinder_leaves_a_map_and_it_is_said_how_many_readings_failed(live: Live) -> None:
    robot = office()
    spoil(robot, good=4, of=5)
    async with live(robot, QUICK) as it:
        said = await it.done(MapStart.of("office", robot.stops_m[:1], robot.start))
        assert it.daemon.supervisor.whereabouts.map_in_use is not None
        assert it.daemon.supervisor.whereabouts.map_in_use.generation == 2
    assert [text for text in messages(said) if "stop" not in text] == [
        "22 of 120 readings failed",
        "24 of 120 readings failed",
    ]
    assert messages(said)[-1] == (
        "2 stops swept; stop 0: 22 of 120 readings failed; stop 1: 24 of 120 readings failed"
        "; the map office is not saved yet: robotctl map save"
    )


async def test_a_rangefinder_that_fails_too_often_ends_the_mission_not_the_map(live: Live) -> None:
    robot = office()
    async with live(robot, QUICK) as it:
        await it.done(MapStart.of("office", (), robot.start))
        board = spoil(robot, good=1, of=5)
        place = it.daemon.supervisor.whereabouts.map_in_use
        said, end = await it.do(Localize())
        assert end.phase is MissionPhase.FAILED
        assert end.message == "the rangefinder failed at 61 of 86 readings, the last was weak"
        assert it.daemon.supervisor.mode is Mode.IDLE
        assert it.daemon.supervisor.whereabouts.map_in_use is place
        await asyncio.sleep(0.1)
        assert not board._lit
    assert max(event.rejected for event in said if isinstance(event, SweepProgress)) >= 50


async def test_a_rangefinder_that_answers_nothing_is_given_up_by_the_setting(live: Live) -> None:
    robot = office()
    config = replace(QUICK, sweep=SweepSettings(readings=120, readings_min_share=0.9, shot_timeout_s=0.2))
    async with live(robot, config) as it:
        board = own_board(robot, "rangefinder")
        assert isinstance(board, RangefinderBoard)
        board._plant.shoot = lambda at_us: ShotAnswer(ShotStatus.OK, 1.0, 9, 10_000_000)  # type: ignore[method-assign]  # takes for ever
        _, end = await it.do(MapStart.of("office", (), robot.start))
        assert end.message == "the rangefinder failed at 13 of 13 readings, the last was device_error"


def emulated_ptu(robot: SimulatedRobot) -> PtuEmulator:
    ptu = getattr(robot.boards["pantilt"], "device", None)
    assert isinstance(ptu, PtuEmulator)
    return ptu


async def lose_steps(it: Living, times: int) -> None:
    """Push the head to its stop in the middle of each of the next sweeps."""
    with it.daemon.control.events.subscribe(depth=100_000) as events:
        for _ in range(times):
            async for event in events:
                if isinstance(event, SweepProgress) and event.taken == 40:
                    break
            emulated_ptu(it.robot).hit_limit("P")  # type: ignore[arg-type]  # it is simulated


async def test_a_head_that_loses_steps_is_reset_and_the_sweep_taken_again(live: Live) -> None:
    robot = office(Dialects(pantilt="ptu"))
    async with live(robot, config_for(Dialects(pantilt="ptu"))) as it:
        losing = asyncio.create_task(lose_steps(it, 2))
        said = await it.done(MapStart.of("office", (), robot.start))
        await losing
        assert it.daemon.supervisor.whereabouts.map_in_use is not None
        assert it.daemon.supervisor.whereabouts.map_in_use.generation == 1
        again = [text for text in messages(said) if "met its stop" in text]
        assert [text.rpartition("; ")[2] for text in again] == [
            "it is reset and the sweep taken again (1 of 2)",
            "it is reset and the sweep taken again (2 of 2)",
        ]
        assert (await it.do(Localize()))[1].message.startswith("localized")


async def test_a_head_that_loses_steps_again_and_again_ends_the_mission(live: Live) -> None:
    robot = office(Dialects(pantilt="ptu"))
    config = replace(config_for(Dialects(pantilt="ptu")), sweep=SweepSettings(readings=120, resets=1))
    async with live(robot, config) as it:
        losing = asyncio.create_task(lose_steps(it, 2))
        _, end = await it.do(MapStart.of("office", (), robot.start))
        await losing
        assert end.message == "pantilt: lost_steps: the pan axis met its stop: it must be reset"
        assert it.daemon.supervisor.mode is Mode.DISARMED


async def ended(daemon: Daemon, mission_id: int) -> list[Event]:
    said: list[Event] = []
    with daemon.control.events.subscribe(depth=100_000) as events:
        async for event in events:
            said.append(event)
            if isinstance(event, MissionProgress) and event.mission_id == mission_id and event.is_last:
                return said
    raise AssertionError("a subscription never ends")


async def test_without_a_base_it_still_says_where_it_stands(tmp_path: Path) -> None:
    robot = office()
    config = in_directory(Config(), tmp_path)
    async with cables(robot) as laid:
        connects = {device: cable.connect for device, cable in laid.items()}
        daemon = compose(config, connects, head_on(AtOnce(), config), unpaced(AtOnce()), new_journal(config))
        parts = [asyncio.create_task(part) for part in daemon.parts().values()]
        await until_ready(daemon)
        await daemon.control.perform(Arm())
        await ended(daemon, daemon.control.start(MapStart.of("office", robot.stops_m, robot.start), 1e4))
        laid["drive"].unplug()
        await asyncio.sleep(1.0)
        assert daemon.supervisor.mode is Mode.DISARMED
        await daemon.control.perform(Arm())
        tie = daemon.supervisor.whereabouts.tie
        assert tie is not None
        said = await ended(daemon, daemon.control.start(Localize(), 1e4))
        estimate = [event for event in said if isinstance(event, PoseEstimate) and event.final][-1]
        assert estimate.state is PoseState.LOCALIZED
        assert estimate.best is not None
        assert estimate.best.distance_m(robot.truth) < 0.15
        assert 200 < estimate.readings < 300  # those that the head reaches without a turn of the base
        assert daemon.supervisor.whereabouts.tie is tie
        with pytest.raises(MissionError, match="the robot can only look where it stands"):
            daemon.control.start(MapStart.of("again", (), robot.start), 1e4)
        laid["drive"].plug()
        await asyncio.sleep(6.0)
        assert daemon.robot.drive.status.link is LinkState.READY
        assert daemon.supervisor.mode.value == "disarmed"
        await daemon.control.perform(Stop("the test is over"))
        for part in parts:
            part.cancel()
        await asyncio.gather(*parts, return_exceptions=True)


async def test_a_battery_that_runs_low_stops_the_robot_and_stays_a_fault(live: Live) -> None:
    config = replace(QUICK, drive=replace(Config().drive, battery_min_v=25.598))
    async with live(office(), config) as it:
        assert it.daemon.supervisor.mode is Mode.IDLE
        await asyncio.sleep(30.0)
        assert it.daemon.supervisor.mode.value == "fault"
        assert "battery is at 25.6 V, below 25.598 V" in it.daemon.control.status.reason
        with pytest.raises(MissionError, match="faults remain"):
            await it.daemon.control.perform(Clear())
