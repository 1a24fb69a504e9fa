import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.core.pose import IDENTITY, Pose2
from robotd.sim.buildings.world import load_world
from robotd.sim.physics.body import Body, BodySettings
from robotd.sim.physics.noise import NOISELESS, NoiseSettings, stream
from robotd.sim.physics.walls import NO_WALLS, WallSegments, clearance_m

COUNTS_PER_M, COUNTS_PER_RAD = 27300.0, 4096.0
WALL_AHEAD = WallSegments.of([((1.0, -2.0), (1.0, 2.0), math.inf)])
SPEED = st.floats(-0.6, 0.6).map(lambda value: round(value, 3))


def body(
    walls: WallSegments = NO_WALLS, start: Pose2 = IDENTITY, noise: NoiseSettings = NOISELESS, seed: int = 1
) -> Body:
    made = Body(walls, start, BodySettings(), noise, stream(seed, "drive"))
    made.advance(0)
    return made


def run_for(plant: Body, seconds: float, from_us: int = 0) -> int:
    to_us = from_us + round(seconds * 1e6)
    for now_us in range(from_us, to_us, 7_000):
        plant.advance(now_us)
    plant.advance(to_us)
    return to_us


def test_it_ramps_up_goes_on_and_ramps_down() -> None:
    plant = body()
    plant.command(0.3, 0.0)
    now_us = run_for(plant, 0.25)
    assert plant.velocity == pytest.approx((0.15, 0.0))
    now_us = run_for(plant, 1.75, now_us)
    assert plant.velocity == pytest.approx((0.3, 0.0))
    plant.command(0.0, 0.0)
    still_rolls = not plant.at_rest
    assert still_rolls
    run_for(plant, 1.0, now_us)
    assert plant.at_rest
    way_m = 0.3 * 2.0  # both ramps take half a second: together they cost as much as half a second of plateau
    assert plant.true_pose.x_m == pytest.approx(way_m, abs=1e-9)
    assert plant.counts[0] == pytest.approx(way_m * COUNTS_PER_M, abs=1)
    assert plant.counts[1] == 0


def test_it_goes_round_in_an_exact_circle() -> None:
    plant = body()
    plant.command(0.3, 0.5)
    now_us = run_for(plant, 2.0)
    centre = plant.true_pose.transform(0.0, 0.6)
    for _ in range(5):
        now_us = run_for(plant, 1.1, now_us)
        assert math.dist(centre, (plant.true_pose.x_m, plant.true_pose.y_m)) == pytest.approx(0.6, abs=1e-6)


def test_it_goes_no_faster_than_its_motors() -> None:
    plant = body()
    plant.command(5.0, -40.0)
    run_for(plant, 5.0)
    assert plant.velocity == (0.9, -2.5)


def test_cut_motors_stand_at_once() -> None:
    plant = body()
    plant.command(0.5, 1.0)
    now_us = run_for(plant, 2.003)
    stood = plant.true_pose
    plant.cut()
    run_for(plant, 1.0, now_us)
    assert plant.at_rest
    assert plant.true_pose == stood


COMMANDS = st.lists(st.tuples(st.integers(1_000, 900_000), SPEED, SPEED), min_size=1, max_size=5)


@settings(max_examples=40, deadline=None)
@given(COMMANDS, st.lists(st.integers(1, 120_000), max_size=30))
def test_how_time_is_cut_changes_nothing(commands: list[tuple[int, float, float]], looks_us: list[int]) -> None:
    walls = load_world("office").walls
    start = Pose2(1.0, 1.1, 0.3)
    straight, looked_at = (body(walls, start, NoiseSettings()) for _ in range(2))
    now_us = 0
    for wait_us, speed, turn in commands:
        for look_us in sorted(looks_us):
            if look_us < wait_us:
                looked_at.advance(now_us + look_us)
                assert looked_at.counts
                assert looked_at.bumpers >= 0
        now_us += wait_us
        for plant in (straight, looked_at):
            plant.advance(now_us)
            plant.command(speed, turn)
    for plant in (straight, looked_at):
        plant.advance(now_us + 1_234_567)
    assert straight.true_pose == looked_at.true_pose
    assert straight.counts == looked_at.counts
    assert (straight.bumpers, straight.velocity) == (looked_at.bumpers, looked_at.velocity)


def test_what_it_shows_between_knots_lies_on_the_way() -> None:
    plant = body()
    plant.command(0.5, 0.0)
    now_us = run_for(plant, 2.0)
    plant.advance(now_us + 2_500)
    halfway = plant.true_pose.x_m
    plant.advance(now_us + 5_000)
    assert plant.true_pose.x_m - halfway == pytest.approx(0.00125)


def test_time_never_runs_back() -> None:
    plant = body()
    plant.command(0.5, 0.0)
    run_for(plant, 1.0)
    there = plant.true_pose
    plant.advance(500_000)
    assert plant.true_pose == there


def test_a_wall_stops_it_and_presses_the_bumper_that_touches() -> None:
    for heading_rad, speed_mps, bit in ((0.0, 0.5, 0), (math.pi / 4, 0.5, 14), (math.pi, -0.5, 8)):
        plant = body(WALL_AHEAD, Pose2(0.0, 0.0, heading_rad))
        plant.command(speed_mps, 0.0)
        assert plant.bumpers == 0
        run_for(plant, 8.0)
        assert 0.3 <= clearance_m(WALL_AHEAD, (plant.true_pose.x_m, plant.true_pose.y_m)) < 0.305
        assert plant.bumpers == 1 << bit
        assert plant.velocity[0] == pytest.approx(0.0, abs=0.01)
        stalled_at = plant.counts[0]
        plant.command(-speed_mps, 0.0)
        run_for(plant, 2.0, 8_000_000)
        assert plant.bumpers == 0
        assert abs(plant.counts[0]) < abs(stalled_at)


@settings(max_examples=25, deadline=None)
@given(st.lists(st.tuples(st.floats(-0.9, 0.9), st.floats(-2.5, 2.5)), min_size=1, max_size=6))
def test_it_never_enters_a_wall(commands: list[tuple[float, float]]) -> None:
    walls = load_world("office").walls
    plant = body(walls, Pose2(1.0, 1.1, 0.0), NoiseSettings())
    now_us = 0
    for speed_mps, turn_radps in commands:
        plant.command(speed_mps, turn_radps)
        now_us = run_for(plant, 1.0, now_us)
        assert clearance_m(walls, (plant.true_pose.x_m, plant.true_pose.y_m)) >= 0.3


def test_odometry_errors_are_those_asked_for() -> None:
    noise = replace(NOISELESS, translation_scale_error=0.01, rotation_scale_error=-0.02)
    plant = body(noise=noise)
    plant.command(0.5, 0.0)
    now_us = run_for(plant, 4.0)
    assert plant.true_pose.x_m / (plant.counts[0] / COUNTS_PER_M) == pytest.approx(1.01, abs=1e-4)
    plant.cut()
    plant.command(0.0, 0.5)
    run_for(plant, 4.0, now_us)
    assert plant.true_pose.heading_rad / (plant.counts[1] / COUNTS_PER_RAD) == pytest.approx(0.98, abs=1e-3)


def test_slip_loses_way() -> None:
    plant = body(noise=replace(NOISELESS, slip_share=0.05))
    plant.command(0.5, 0.0)
    run_for(plant, 20.0)
    assert plant.true_pose.x_m / (plant.counts[0] / COUNTS_PER_M) == pytest.approx(0.95, abs=0.01)


def test_the_same_seed_gives_the_same_way_and_another_seed_another() -> None:
    ways = []
    for seed in (1, 1, 2):
        plant = body(noise=NoiseSettings(), seed=seed)
        plant.command(0.5, 0.3)
        run_for(plant, 5.0)
        ways.append(plant.true_pose)
    assert ways[0] == ways[1] != ways[2]


@pytest.mark.parametrize("seed", range(5))
def test_by_default_a_tour_of_the_laboratory_ends_within_centimetres_and_a_degree(seed: int) -> None:
    world = load_world("laboratory")
    plant = body(world.walls, world.start_pose, NoiseSettings(), seed)
    believed, seen, now_us = world.start_pose, plant.counts, 0

    def go(speed_mps: float, turn_radps: float, seconds: float) -> None:
        nonlocal now_us, believed, seen
        for command in ((speed_mps, turn_radps), (0.0, 0.0)):
            plant.command(*command)
            now_us = run_for(plant, seconds if any(command) else 3.0, now_us)
            counts = plant.counts
            way, turn = (counts[0] - seen[0]) / COUNTS_PER_M, (counts[1] - seen[1]) / COUNTS_PER_RAD
            believed, seen = believed @ Pose2(way, 0.0, turn), counts

    for x_m, y_m in world.stops_m:
        bearing_rad = math.atan2(y_m - believed.y_m, x_m - believed.x_m)
        turn_rad = math.remainder(bearing_rad - believed.heading_rad, math.tau)
        go(0.0, math.copysign(0.5, turn_rad), abs(turn_rad) / 0.5)
        go(0.3, 0.0, math.hypot(x_m - believed.x_m, y_m - believed.y_m) / 0.3)
        go(0.0, 1.0, 0.7)  # the half turn that a limited pan asks of each sweep
        go(0.0, -1.0, 0.7)
    assert plant.bumpers == 0
    assert believed.distance_m(plant.true_pose) < 0.08
    assert abs(math.remainder(believed.heading_rad - plant.true_pose.heading_rad, math.tau)) < math.radians(1.0)


def test_the_battery_drains_slowly() -> None:
    plant = body()
    full_mv = plant.battery_mv
    plant.advance(3_600_000_000)
    assert full_mv - plant.battery_mv == 500


def test_time_may_begin_anywhere() -> None:
    plant = Body(NO_WALLS, IDENTITY, BodySettings(), NOISELESS, stream(1, "drive"))
    plant.advance(10**15)
    assert plant.battery_mv == 25_600
    plant.command(0.5, 0.0)
    plant.advance(10**15 + 2_000_000)
    assert plant.velocity == (0.5, 0.0)


@pytest.mark.parametrize("name", ["radius_m", "acceleration_mps2", "counts_per_m"])
def test_impossible_settings_are_refused(name: str) -> None:
    with pytest.raises(ValueError, match=f"{name} must be positive"):
        BodySettings(**{name: 0})
