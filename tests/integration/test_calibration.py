"""A daemon with wrong constants on a simulated robot: each calibration finds the right ones."""

import math
from dataclasses import replace

import pytest

from robotd.calibration.head_zero import calibrate_head
from robotd.calibration.range_bias import calibrate_range
from robotd.calibration.wheel_scales import calibrate_heading, calibrate_odometry
from robotd.config import Config
from robotd.contract.missions import Look, Turn
from robotd.sim.buildings.world import load_world
from robotd.sim.physics.laser import LaserSettings
from robotd.sim.physics.noise import NoiseSettings
from robotd.sim.physics.steppers import StepperSettings
from robotd.sim.robot import SimSettings, SimulatedRobot
from tests.integration.conftest import Live
from tests.support.calibrating import by_key, carried_out, constants
from tests.support.true_range import true_range_m

pytestmark = pytest.mark.slow

NOISE = NoiseSettings()
COUNTS_PER_M = 27_300.0 / (1.0 + NOISE.translation_scale_error) / (1.0 - NOISE.slip_share)
COUNTS_PER_RAD = 4_096.0 / (1.0 + NOISE.rotation_scale_error)
PLAY_RAD, PLAY_KNOWN_RAD = math.radians(5.4), math.radians(3.0)
READINGS = 180
"""Of a sweep: more only take longer."""
PAN_ZERO_RAD, RANGE_BIAS_M = 0.06, -0.05


def robot_and_config(world: str = "laboratory", seed: int = 3) -> tuple[SimulatedRobot, Config]:
    """A robot whose constants are not those that the daemon is told."""
    settings = SimSettings(
        head=StepperSettings(backlash_rad=PLAY_RAD), laser=LaserSettings(pan_zero_rad=PAN_ZERO_RAD, range_bias_m=0.05)
    )
    config = Config()
    wrong = replace(
        config,
        drive=replace(config.drive, counts_per_m=25_000.0, counts_per_rad=4_400.0),
        pantilt=replace(config.pantilt, backlash_rad=PLAY_KNOWN_RAD),
        sweep=replace(config.sweep, readings=READINGS),
    )
    return SimulatedRobot(load_world(world), seed, settings), wrong


async def test_odometry_is_found_to_half_a_percent(live: Live) -> None:
    robot, config = robot_and_config()
    async with live(robot, config) as it:
        found = by_key(await carried_out(it, calibrate_odometry(constants(config), 1.5)))
    assert found["counts_per_m"].value == pytest.approx(COUNTS_PER_M, rel=0.005)
    assert found["counts_per_rad"].value == pytest.approx(COUNTS_PER_RAD, rel=0.005)
    for one in found.values():
        assert 0.0 < one.error < 0.005 * one.value


async def test_the_heading_is_found_to_a_thousandth(live: Live) -> None:
    robot, config = robot_and_config()
    async with live(robot, config) as it:
        (found,) = (await carried_out(it, calibrate_heading(constants(config)))).found
    assert found.value == pytest.approx(COUNTS_PER_RAD, rel=0.001)
    assert found.error < 0.001 * found.value


async def test_zero_and_play_of_the_head_are_found(live: Live) -> None:
    robot, config = robot_and_config()
    async with live(robot, config) as it:
        found = by_key(await carried_out(it, calibrate_head(constants(config), 1.5)))
    # Half a percent of a radian is 0.3 degrees.
    assert found["backlash_rad"].value == pytest.approx(PLAY_RAD, abs=0.005)
    assert found["pan_zero_rad"].value == pytest.approx(PAN_ZERO_RAD, abs=0.005)


async def test_a_head_without_play_has_no_less_than_none(live: Live) -> None:
    _, config = robot_and_config()
    tight = replace(config, pantilt=replace(config.pantilt, backlash_rad=0.0))
    for seed in range(2):  # noise says a little less than none in one of two
        async with live(SimulatedRobot(load_world("laboratory"), seed), tight) as it:
            found = by_key(await carried_out(it, calibrate_head(constants(tight), 1.5)))
        assert 0.0 <= found["backlash_rad"].value < 0.005


async def test_the_range_bias_is_found_before_a_wall(live: Live) -> None:
    robot, config = robot_and_config()
    async with live(robot, config) as it:
        await it.done(Turn(math.pi * COUNTS_PER_RAD / 4_400.0))
        await it.done(Look(-PAN_ZERO_RAD, 0.0))
        wall_m = true_range_m(robot)
        (found,) = (await carried_out(it, calibrate_range(constants(config), wall_m))).found
    assert found.value == pytest.approx(RANGE_BIAS_M, abs=0.005 * wall_m)
    assert 0.0 < found.error < 0.005
