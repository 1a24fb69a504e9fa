"""Missions begin where they can, one at a time, and end with the reason that was."""

import asyncio

import pytest

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import MissionPhase
from robotd.contract.missions import DriveTo, Legs, Localize, MapStart
from robotd.contract.modes import Mode
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.errors import MissionError
from robotd.core.pose import STANDSTILL, Odometry, Pose2
from tests.support.places import place
from tests.unit.mission.scripted_rig import (
    GONE,
    rig,
    turns,
)


async def test_a_mission_stopped_before_its_first_step_says_so_and_gives_its_lease_back() -> None:
    async with rig() as r:
        mission_id = r.supervisor.mission.start(MapStart("new", ()), 0.5)
        await r.supervisor.stop("changed my mind")
        end = await r.end_of_mission()
        assert (end.mission_id, end.phase, end.message) == (mission_id, MissionPhase.STOPPED, "changed my mind")
        await asyncio.sleep(1.0)
        assert r.reason == "changed my mind"


async def test_a_lost_drive_is_why_a_drive_ended() -> None:
    async with rig() as r:
        r.use_map()
        r.supervisor.mission.start(DriveTo(1.0, 0.0, Legs.STRAIGHT), 100.0)
        await asyncio.sleep(1.0)
        assert r.drive.told
        r.drive.change(**GONE)
        end = await r.end_of_mission()
        assert (end.phase, end.message) == (MissionPhase.STOPPED, "drive is gone: the line was cut")
        assert r.reason == "drive is gone: the line was cut"


async def test_a_base_that_does_not_move_is_stopped() -> None:
    async with rig() as r:
        r.use_map()
        r.supervisor.mission.start(DriveTo(1.0, 0.0, Legs.STRAIGHT), 100.0)
        end = await r.end_of_mission()
        assert end.phase is MissionPhase.FAILED
        assert "stalled: drive is no nearer" in end.message
        assert r.mode is Mode.DISARMED


async def test_without_odometry_nothing_begins() -> None:
    async with rig(talking=False) as r:
        r.supervisor.mission.start(MapStart("new", ((1.0, 0.0),)), 100.0)
        began_ns = now_ns()
        end = await r.end_of_mission()
        assert (end.phase, end.message) == (MissionPhase.FAILED, "drive: no odometry for 0.5 s")
        assert now_ns() - began_ns < NS_PER_S
        assert r.mode is Mode.DISARMED
        assert r.supervisor.whereabouts.map_in_use is None
        assert r.drive.told == []


async def test_a_head_that_is_stuck_stops_the_robot() -> None:
    async with rig() as r:
        r.supervisor.mission.start(MapStart("new", ()), 100.0)
        end = await r.end_of_mission()
        assert (end.phase, end.message) == (MissionPhase.FAILED, "pantilt: still turning")
        assert r.mode is Mode.DISARMED


async def test_a_mission_that_cannot_be_done_leaves_the_robot_armed_and_idle() -> None:
    async with rig() as r:
        r.supervisor.mission.start(Localize(), 100.0)
        end = await r.end_of_mission()
        assert end.phase is MissionPhase.FAILED
        assert "no map is in use" in end.message
        assert r.mode is Mode.IDLE
        assert r.supervisor.status.mission_id is None


async def test_an_error_of_ours_in_a_mission_stops_the_robot(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise ValueError("a mistake of ours")

    async with rig() as r:
        r.use_map()
        monkeypatch.setattr("robotd.mission.missions.rows.run_driving", fail)
        r.supervisor.mission.start(DriveTo(1.0, 0.0), 100.0)
        end = await r.end_of_mission()
        assert end.phase is MissionPhase.FAILED
        assert "a mistake of ours" in end.message
        assert r.mode is Mode.DISARMED


async def test_one_mission_at_a_time_under_a_lease_that_only_it_renews() -> None:
    async with rig(armed=False) as r:
        with pytest.raises(MissionError, match="arm it first"):
            r.supervisor.mission.start(MapStart("new", ()), 0.5)
        await r.supervisor.arming.arm()
        mission_id = r.supervisor.mission.start(MapStart("new", ()), 0.5)
        with pytest.raises(MissionError, match="while mapping"):
            r.supervisor.mission.start(Localize(), 0.5)
        with pytest.raises(MissionError, match="while mapping"):
            await r.supervisor.arming.arm()
        with pytest.raises(MissionError, match="while a mission is under way"):
            r.use_map()
        with pytest.raises(MissionError, match="not under way"):
            r.supervisor.mission.renew(mission_id + 1)
        await asyncio.sleep(0.4)
        r.supervisor.mission.renew(mission_id)
        assert r.supervisor.status.mission_id == mission_id
        await asyncio.sleep(0.4)
        assert r.supervisor.status.mode == "mapping"
        await asyncio.sleep(0.2)
        assert r.mode.value == "disarmed"
        with pytest.raises(MissionError, match=rf"not under way any more: the lease of mission {mission_id} expired"):
            r.supervisor.mission.renew(mission_id)


async def test_a_pose_is_never_predicted_where_nothing_ties_odometry_to_the_map() -> None:
    async with rig(armed=False, talking=False) as r:
        with r.supervisor.news.events.subscribe() as events:
            r.supervisor.use(place())
            r.drive.odometry.publish(Odometry(now_ns(), Pose2(1.0, 2.0, 0.0), STANDSTILL))
            await turns()
            said = [await events.get() for _ in range(4)]
        assert [type(event).__name__ for event in said] == ["MapChanged", "PoseEstimate", "Status", "Odometry"]
        assert isinstance(said[1], PoseEstimate)
        assert said[1].state is PoseState.LOST
