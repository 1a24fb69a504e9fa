"""The second look decides between rivals where something tells them apart, and says so where nothing does."""

import math
from dataclasses import asdict, dataclass, replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from robotd.contract.estimate import PoseState
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import IDENTITY, Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.readings import Readings
from robotd.grid.settings import GridSettings
from robotd.grid.tables import NO_INFORMATION
from robotd.localization.judge import second_look as judging
from robotd.localization.judge.climbing import Hill
from robotd.localization.judge.ends import ends_at
from robotd.localization.judge.error_model import ErrorModel
from robotd.localization.judge.likelihood import Likelihood
from robotd.localization.judge.second_look import (
    SecondLook,
    second_look,
    share_on_walls,
)
from robotd.localization.judge.second_look_settings import SecondLookSettings
from robotd.localization.judge.shortlist import near
from robotd.sim.physics.walls import WallSegments, ray_cast

CUT_OFF_M = 6.0
Box = tuple[float, float, float, float]
"""x, y, width and depth."""
ROOM = (0.0, 0.0, 6.0, 4.0)
TWIN = (8.0, 0.0, 6.0, 4.0)
CABINET = (4.8, 3.2, 0.8, 0.8)


@dataclass(frozen=True)
class World:
    """Boxes seen from outside and inside, and where the robot stood to map them."""

    boxes: tuple[Box, ...]
    stops_m: tuple[tuple[float, float], ...]


def walls_of(boxes: tuple[Box, ...]) -> WallSegments:
    sides = []
    for x, y, width, depth in boxes:
        corners = [(x, y), (x + width, y), (x + width, y + depth), (x, y + depth)]
        sides += [(one, other, math.inf) for one, other in zip(corners, corners[1:] + corners[:1], strict=True)]
    return WallSegments.of(sides)


def scan(
    boxes: tuple[Box, ...], pose: Pose2, rng: np.random.Generator, sigma_m: float, wrong: float
) -> list[RangeReading]:
    """Return 180 readings all round: noise, and a share of them anywhere."""
    walls, readings = walls_of(boxes), []
    for bearing_rad in np.arange(180) * (math.tau / 180):
        range_m = ray_cast(walls, (pose.x_m, pose.y_m), pose.heading_rad + bearing_rad) + rng.normal(0.0, sigma_m)
        if rng.random() < wrong:
            range_m = rng.uniform(0.3, CUT_OFF_M)
        status = ReadingStatus.OK if range_m < CUT_OFF_M else ReadingStatus.MISS
        readings.append(RangeReading(0, float(bearing_rad), status, float(np.clip(range_m, 0.05, CUT_OFF_M))))
    return readings


@cache
def mapped(world: World) -> Likelihood:
    rng = np.random.default_rng(7)
    points_m = np.array([(x + w * i, y + d * i) for x, y, w, d in world.boxes for i in (0, 1)])
    low_m, size_m = points_m.min(axis=0) - 0.5, np.ptp(points_m, axis=0) + 1.0
    spec = GridSpec(0.05, float(low_m[0]), float(low_m[1]), (int(size_m[1] / 0.05), int(size_m[0] / 0.05)))
    grid = OccupancyGrid(spec, settings=GridSettings(raise_alpha=0.5, lower_alpha=0.9))
    for x_m, y_m in world.stops_m:
        pose = Pose2(x_m, y_m, rng.uniform(-3, 3))
        grid.insert(Sweep(0, IDENTITY, tuple(scan(world.boxes, pose, rng, 0.015, 0.0))), pose)
    return Likelihood.of(spec, grid.cells, ErrorModel())


def everywhere(likelihood: Likelihood, truth: Pose2, others: tuple[Pose2, ...] = ()) -> NDArray[np.float64]:
    """Return where to start: all over the map, and near to some poses."""
    rng = np.random.default_rng(3)
    rows, cols = np.nonzero(likelihood.chances.cells < 128)
    picked = rng.integers(0, len(rows), 40)
    at = [likelihood.spec.centre_of(int(rows[i]), int(cols[i])) for i in picked]
    poses = [(*place, rng.uniform(-3, 3)) for place in at]
    return np.array([(p.x_m + 0.04, p.y_m - 0.03, p.heading_rad + 0.01) for p in (truth, *others)] + poses)


def look(world: World, readings: list[RangeReading], starts: NDArray[np.float64]) -> SecondLook:
    ranks = np.full(len(starts), 100)
    return second_look(mapped(world), Readings.of(readings), starts, ranks, SecondLookSettings())


def is_at(found: NDArray[np.float64], pose: Pose2, within_m: float = 0.1) -> bool:
    return bool(near(found[None], np.array([pose.x_m, pose.y_m, pose.heading_rad]), within_m, 0.0873)[0])


STOPS = ((1.0, 1.0), (3.0, 2.0), (5.0, 1.5), (2.0, 3.0))
PLAIN = World((ROOM,), STOPS)
FURNISHED = World((ROOM, CABINET), STOPS)
TWINS = World((ROOM, TWIN), (*STOPS, *((x + 8.0, y) for x, y in STOPS)))
TWINS_ONE_FURNISHED = World((ROOM, TWIN, CABINET), TWINS.stops_m)
HALLWAY = World(((0.0, 0.0, 24.0, 2.0),), tuple((1.0 + 2 * k, 1.0) for k in range(12)))
HERE = Pose2(1.7, 1.4, 0.6)


def turned_about(pose: Pose2) -> Pose2:
    """Return where a robot in the plain room would see the same."""
    return Pose2(6.0 - pose.x_m, 4.0 - pose.y_m, pose.heading_rad + math.pi)


def moved(pose: Pose2, x_m: float) -> Pose2:
    return Pose2(pose.x_m + x_m, pose.y_m, pose.heading_rad)


def test_a_symmetric_room_is_ambiguous_and_both_places_are_told() -> None:
    readings = scan(PLAIN.boxes, HERE, np.random.default_rng(1), 0.015, 0.02)
    result = look(PLAIN, readings, everywhere(mapped(PLAIN), HERE, (turned_about(HERE),)))
    assert result.state is PoseState.AMBIGUOUS
    for place in (HERE, turned_about(HERE)):
        assert any(is_at(found, place) for found in result.poses[:2])
    assert result.beliefs[:2].min() > 0.02


def test_a_room_that_exists_twice_is_ambiguous() -> None:
    readings = scan(TWINS.boxes, HERE, np.random.default_rng(2), 0.015, 0.02)
    others = (moved(HERE, 8.0), turned_about(HERE), moved(turned_about(HERE), 8.0))
    result = look(TWINS, readings, everywhere(mapped(TWINS), HERE, others))
    assert result.state is PoseState.AMBIGUOUS
    assert any(is_at(found, HERE) for found in result.poses[:4])
    assert any(is_at(found, moved(HERE, 8.0)) for found in result.poses[:4])


@pytest.mark.parametrize("seed", range(4))
def test_one_piece_of_furniture_decides(seed: int) -> None:
    rng = np.random.default_rng(seed)
    at = Pose2(rng.uniform(1, 4), rng.uniform(1, 2.5), rng.uniform(-3, 3))
    readings = scan(TWINS_ONE_FURNISHED.boxes, at, rng, 0.015, 0.02)
    others = (moved(at, 8.0), turned_about(at), moved(turned_about(at), 8.0))
    result = look(TWINS_ONE_FURNISHED, readings, everywhere(mapped(TWINS_ONE_FURNISHED), at, others))
    assert result.state is PoseState.LOCALIZED
    assert is_at(result.poses[0], at)


def test_along_a_hallway_nothing_holds_the_pose() -> None:
    at = Pose2(12.0, 0.9, 0.3)
    readings = scan(HALLWAY.boxes, at, np.random.default_rng(4), 0.015, 0.0)
    one = look(HALLWAY, readings, np.array([[12.0, 0.9, 0.3]]))
    many = look(HALLWAY, readings, np.array([[12.0 + x_m, 0.9, 0.3] for x_m in np.arange(-3, 3, 0.4)]))
    assert one.state is many.state is PoseState.AMBIGUOUS
    assert one.aside > 0.05
    assert np.ptp(many.poses[:, 0]) > 2.0


def test_at_the_end_of_a_hallway_its_end_holds_the_pose() -> None:
    at = Pose2(3.0, 0.9, 0.3)
    readings = scan(HALLWAY.boxes, at, np.random.default_rng(4), 0.015, 0.0)
    result = look(HALLWAY, readings, np.array([[3.05, 0.9, 0.3]]))
    assert result.state is PoseState.LOCALIZED
    assert is_at(result.poses[0], at)


@pytest.mark.parametrize("seed", range(6))
def test_in_a_room_that_is_not_on_the_map_nothing_is_claimed(seed: int) -> None:
    rng = np.random.default_rng(seed)
    other = ((0.0, 0.0, 4.3, 5.1), (1.0, 3.9, 1.4, 0.5), (3.6, 0.8, 0.7, 1.5))
    at = Pose2(2.0, rng.uniform(1, 3), rng.uniform(-3, 3))
    readings = scan(other, at, rng, 0.015, 0.0)
    result = look(FURNISHED, readings, everywhere(mapped(FURNISHED), HERE, (turned_about(HERE), Pose2(3.0, 2.0, 0.0))))
    assert result.state is PoseState.LOST


def test_the_same_readings_give_the_same_answer() -> None:
    readings = scan(FURNISHED.boxes, HERE, np.random.default_rng(5), 0.015, 0.02)
    starts = everywhere(mapped(FURNISHED), HERE)
    one, other = look(FURNISHED, readings, starts), look(FURNISHED, readings, starts)
    assert one.state is other.state
    assert np.array_equal(one.poses, other.poses)
    assert np.array_equal(one.beliefs, other.beliefs)


def test_the_shares_make_a_whole() -> None:
    readings = scan(PLAIN.boxes, HERE, np.random.default_rng(6), 0.05, 0.1)
    result = look(PLAIN, readings, everywhere(mapped(PLAIN), HERE))
    assert result.beliefs.sum() + result.aside + result.nowhere == pytest.approx(1.0)
    assert (np.diff(result.evidence) <= 0.0).all()


@pytest.mark.parametrize("seed", range(6))
def test_more_noise_makes_less_sure_never_sure_and_wrong(seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    at = Pose2(rng.uniform(1, 4), rng.uniform(1, 2.5), rng.uniform(-3, 3))
    starts = everywhere(mapped(FURNISHED), at, (turned_about(at),))
    for sigma_m, wrong in ((0.01, 0.0), (0.03, 0.05), (0.06, 0.1), (0.12, 0.2), (0.25, 0.4), (0.5, 0.8)):
        result = look(FURNISHED, scan(FURNISHED.boxes, at, rng, sigma_m, wrong), starts)
        assert result.state is not PoseState.LOCALIZED or is_at(result.poses[0], at, 0.3)
    assert result.state is PoseState.LOST


def test_without_poses_or_readings_the_robot_is_lost() -> None:
    readings = Readings.of(scan(PLAIN.boxes, HERE, np.random.default_rng(1), 0.015, 0.0))
    settings, nothing = SecondLookSettings(), np.zeros((0, 3))
    assert second_look(mapped(PLAIN), readings, nothing, np.zeros(0, int), settings).state is PoseState.LOST
    one = second_look(mapped(PLAIN), readings[:0], np.zeros((1, 3)), np.ones(1, int), settings)
    assert one.state is PoseState.LOST


@pytest.mark.parametrize("name", list(asdict(SecondLookSettings())))
def test_impossible_settings_are_refused(name: str) -> None:
    with pytest.raises(ValueError, match=name):
        SecondLookSettings(**{name: -1})


def test_a_dozen_readings_are_believed_but_do_not_stand_out_from_nowhere() -> None:
    readings = Readings.of(scan(FURNISHED.boxes, HERE, np.random.default_rng(1), 0.015, 0.02))
    starts, usual = everywhere(mapped(FURNISHED), HERE), SecondLookSettings()
    ranks, on_belief_alone = np.full(len(starts), 100), replace(usual, contrast_nowhere_min=0.0)
    for count, settings, is_sure in ((12, on_belief_alone, True), (12, usual, False), (60, usual, True)):
        state = second_look(mapped(FURNISHED), readings[:count], starts, ranks, settings).state
        assert state is (PoseState.LOCALIZED if is_sure else PoseState.AMBIGUOUS)


def test_one_of_two_rooms_that_exist_twice_is_seldom_taken_for_sure() -> None:
    sure = 0
    for seed in range(8):
        rng = np.random.default_rng(seed)
        here = Pose2(rng.uniform(1, 5), rng.uniform(1, 3), rng.uniform(-3, 3))
        others = (moved(here, 8.0), turned_about(here), moved(turned_about(here), 8.0))
        result = look(TWINS, scan(TWINS.boxes, here, rng, 0.015, 0.02), everywhere(mapped(TWINS), here, others))
        sure += result.state is PoseState.LOCALIZED
    assert sure <= 1


def test_ranges_of_kilometres_are_weighed_like_others() -> None:
    far = [RangeReading(0, 0.1 * k, ReadingStatus.OK, 10_000.0) for k in range(30)]
    result = look(PLAIN, far, everywhere(mapped(PLAIN), HERE))
    assert result.state is PoseState.LOST


def brute_share_on_walls(the_map: Likelihood, readings: Readings, pose: Pose2, on_wall_m: float) -> float:
    """Ask every wall cell, for every hit."""
    walls = np.argwhere(the_map.chances.cells > NO_INFORMATION)
    spec, found = the_map.spec, []
    for bearing_rad, range_m, is_hit in zip(readings.bearing_rad, readings.range_m, readings.is_hit, strict=True):
        if is_hit:
            angle_rad = pose.heading_rad + bearing_rad
            head = spec.cell_at(pose.x_m + range_m * math.cos(angle_rad), pose.y_m + range_m * math.sin(angle_rad))
            distance = np.hypot(*(walls - np.array(head)).T)
            found.append(bool((distance <= max(1.5, on_wall_m / spec.resolution_m)).any()))
    return float(np.mean(found)) if found else 1.0


@pytest.mark.parametrize("seed", range(6))
def test_the_share_of_hits_on_walls_is_what_every_wall_cell_says(seed: int) -> None:
    rng = np.random.default_rng(seed)
    the_map = mapped(FURNISHED)
    readings = Readings.of(scan(FURNISHED.boxes, HERE, rng, 0.05, 0.2))
    for pose in (HERE, moved(HERE, 0.4), turned_about(HERE), Pose2(-30.0, 0.0, 1.0)):
        array = np.array([pose.x_m, pose.y_m, pose.heading_rad])
        for on_wall_m in (0.01, 0.075, 0.2):
            expected = brute_share_on_walls(the_map, readings, pose, on_wall_m)
            assert share_on_walls(the_map, readings, array, on_wall_m) == pytest.approx(expected)


def test_where_hits_end_on_no_wall_a_rival_must_be_beaten_by_more() -> None:
    """A third of the room was changed since it was mapped: the answer stays, and sure it is by what is set."""
    readings = scan(FURNISHED.boxes, HERE, np.random.default_rng(3), 0.015, 0.0)
    changed = [
        replace(one, range_m=0.7 * (one.range_m or 1.0)) if k % 3 == 0 else one for k, one in enumerate(readings)
    ]
    starts = everywhere(mapped(FURNISHED), HERE, (turned_about(HERE),))
    states = {
        least: second_look(
            mapped(FURNISHED),
            Readings.of(changed),
            starts,
            np.ones(len(starts), np.int64),
            SecondLookSettings(contrast_off_walls_min=least),
        ).state
        for least in (0.0, 100.0)
    }
    assert states == {0.0: PoseState.LOCALIZED, 100.0: PoseState.AMBIGUOUS}


@pytest.mark.parametrize(
    ("on_walls", "elsewhere", "beside", "state"),
    [
        (0.95, 2.0, 2.0, PoseState.LOCALIZED),
        (0.85, 4.0, 4.0, PoseState.LOCALIZED),
        (0.85, 2.0, 4.0, PoseState.AMBIGUOUS),
        # Sure of a place 18 m off: a scan of a convention centre, which was not on the map there.
        (0.62, 4.1, 1.46, PoseState.AMBIGUOUS),
    ],
)
def test_off_the_walls_more_is_asked_of_every_rival_on_the_map(
    monkeypatch: pytest.MonkeyPatch, on_walls: float, elsewhere: float, beside: float, state: PoseState
) -> None:
    monkeypatch.setattr(judging, "_contrasts", lambda hill, poses: (elsewhere, beside))
    monkeypatch.setattr(judging, "share_on_walls", lambda *_: on_walls)
    readings = scan(PLAIN.boxes, HERE, np.random.default_rng(3), 0.015, 0.0)
    assert look(PLAIN, readings, everywhere(mapped(PLAIN), HERE)).state is state


def test_how_much_of_a_sweep_the_map_knows_is_told_with_the_place() -> None:
    starts = everywhere(mapped(PLAIN), HERE)
    rng = np.random.default_rng(5)
    known = look(PLAIN, scan(PLAIN.boxes, HERE, rng, 0.015, 0.0), starts).ends
    furnished = look(PLAIN, scan(FURNISHED.boxes, HERE, rng, 0.015, 0.0), starts).ends
    longer = [
        replace(reading, range_m=(reading.range_m or 0.0) + 1.0) for reading in scan(PLAIN.boxes, HERE, rng, 0.015, 0.0)
    ]
    beyond = ends_at(hill_of(PLAIN, longer), np.array([HERE.x_m, HERE.y_m, HERE.heading_rad]))
    assert known is not None
    assert furnished is not None
    assert known.as_mapped > 0.8
    assert furnished.against_map > known.against_map + 0.05
    assert beyond.unseen > 0.3
    for ends in (known, furnished, beyond):
        assert ends.as_mapped + ends.unseen + ends.against_map == pytest.approx(1.0)


def hill_of(world: World, readings: list[RangeReading]) -> Hill:
    likelihood, taken = mapped(world), Readings.of(readings)
    return Hill(likelihood, likelihood.sight(taken), np.ones(len(taken)))
