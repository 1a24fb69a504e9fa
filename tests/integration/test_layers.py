"""Maps of several heights: made at several tilts, stored, gone on with, and localized on by all of their layers."""

from dataclasses import replace
from pathlib import Path

import pytest

from robotd.config import Config
from robotd.contract.arguments import TiltArgument
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import Event, MissionPhase, SweepDone
from robotd.contract.missions import Localize, MapContinue, MapStart, Mission
from robotd.contract.requests import MapLoad, MapSave, RecordStart, RecordStop
from robotd.core.reading import ReadingStatus, Sweep, Tilt
from robotd.maps.store import MapStore
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.sim.buildings.world import load_world
from robotd.sim.robot import SimulatedRobot
from tests.integration.conftest import Live
from tests.support.living import Living
from tests.support.replayed import check, replayed

pytestmark = pytest.mark.slow

_PLAIN = Config(sweep=SweepSettings(readings=150))
MEASURED = replace(_PLAIN, pantilt=replace(_PLAIN.pantilt, height_m=0.55))
DOWN, UP = TiltArgument(-0.24, 2.1), TiltArgument(0.1)
TILTS = (Tilt(-0.24, 2.1), Tilt(0.1, MEASURED.rangefinder.range_max_m))
OFFICE = load_world("office")


def sweeps(said: list[Event]) -> list[Sweep]:
    return [event.sweep for event in said if isinstance(event, SweepDone)]


def found(said: list[Event]) -> PoseEstimate:
    return next(event for event in reversed(said) if isinstance(event, PoseEstimate) and event.final and event.readings)


async def test_a_map_is_made_stored_gone_on_with_and_localized_on_at_several_tilts(live: Live, tmp_path: Path) -> None:
    robot = SimulatedRobot(OFFICE)
    async with live(robot, MEASURED) as it:
        control = it.daemon.control
        recording = await control.perform(RecordStart())
        made = sweeps(await it.done(MapStart.of("office", (), robot.start, tilts=(DOWN, UP))))
        assert [[slant.tilt for slant in sweep.slants] for sweep in made] == [list(TILTS)]
        for slant in (slant for sweep in made for slant in sweep.slants):
            assert len(slant.readings) == 150
            hits_m = [reading.range_m for reading in slant.readings if reading.status is ReadingStatus.OK]
            assert hits_m
            assert max(filter(None, hits_m)) <= slant.tilt.cut_off_m
        # The beam meets the floor at 2.25 m: what is farther is not met.
        down, _ = made[0].slants
        assert sum(reading.status is ReadingStatus.MISS for reading in down.readings) > 20
        estimate = found(await it.done(Localize(layers=True)))
        assert [said.tilt_rad for said in estimate.layers] == [-0.24, 0.1]
        assert all(said.best_rank > 0.5 * said.readings > 0 for said in estimate.layers)
        await control.perform(RecordStop())
        await control.perform(MapSave())
        await control.perform(MapLoad.of("office", None, robot.truth))
        (more,) = sweeps(await it.done(MapContinue.of("office")))
        assert [slant.tilt for slant in more.slants] == list(TILTS)
    assert estimate.state is PoseState.LOCALIZED
    assert estimate.best is not None
    assert estimate.best.distance_m(robot.truth) < 0.1
    stored = MapStore(tmp_path / "maps").load("office")
    assert stored.stops is not None
    assert stored.stops.tilts == TILTS
    assert recording.path is not None
    check(replayed(Path(recording.path)))


async def refused(it: Living, mission: Mission) -> str:
    """Return why a mission fails that must."""
    said, end = await it.do(mission)
    assert end.phase is MissionPhase.FAILED
    assert not sweeps(said)
    return end.message


async def test_a_tilt_is_refused_whose_floor_lies_before_the_cut_off(live: Live) -> None:
    robot = SimulatedRobot(OFFICE)
    async with live(robot, MEASURED) as it:
        for tilts, why in (
            (
                [TiltArgument(-0.24)],
                "at a tilt of -13.8 deg the beam meets the floor at 2.25 m, before its cut-off of 6",
            ),
            ([UP, TiltArgument(-0.24, 2.26)], "the beam meets the floor at 2.25 m, before its cut-off of 2.26 m"),
            ([TiltArgument(-1.2, 0.15)], "the head cannot look there: tilt must be -47.0 to 31.0 deg, got -68.8"),
            ([TiltArgument(-0.24, 0.3)], "nothing is seen: its cut-off must be above 0.30 m, got 0.3"),
            ([TiltArgument(0.0)], "none that of the first look round, which is 0.0 deg"),
            ([DOWN, TiltArgument(-0.24, 1.0)], "each further tilt must be another"),
        ):
            assert why in await refused(it, MapStart.of("office", (), robot.start, tilts=tuple(tilts)))
        assert it.daemon.supervisor.whereabouts.map_in_use is None


async def test_a_head_that_was_not_measured_looks_up_and_not_down(live: Live) -> None:
    robot = SimulatedRobot(OFFICE)
    async with live(robot, _PLAIN) as it:
        message = await refused(it, MapStart.of("office", (), robot.start, tilts=(DOWN,)))
        assert "pantilt.height_m does not say where: measure it" in message
        await it.done(MapStart.of("office", (), robot.start, tilts=(UP,)))


async def test_a_map_that_was_made_at_one_tilt_has_no_layers_to_look_at(live: Live) -> None:
    robot = SimulatedRobot(OFFICE)
    async with live(robot, MEASURED) as it:
        await it.done(MapStart.of("office", (), robot.start))
        _, end = await it.do(Localize(layers=True))
        assert end.phase is MissionPhase.FAILED
        assert "the map in use has no layers" in end.message
