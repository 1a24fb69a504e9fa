import math
import statistics
from dataclasses import replace

import pytest

from firmware_proto.rangefinder_messages import ShotStatus
from robotd.core.pose import Pose2
from robotd.sim.physics.body import Body, BodySettings
from robotd.sim.physics.laser import Laser, LaserSettings
from robotd.sim.physics.noise import NOISELESS, NoiseSettings, stream
from robotd.sim.physics.plant import ShotAnswer
from robotd.sim.physics.steppers import StepperHead, StepperSettings
from robotd.sim.physics.walls import WallSegments

WALL_AT_3_M = WallSegments.of([((3.0, -20.0), (3.0, 20.0), math.inf)])
FINE = StepperSettings(step_rad=1e-9)


class Rig:
    """A laser on a head on a body that stands."""

    def __init__(
        self,
        settings: LaserSettings | None = None,
        noise: NoiseSettings = NOISELESS,
        start: Pose2 | None = None,
        walls: WallSegments = WALL_AT_3_M,
    ) -> None:
        start = start or Pose2(0.0, 0.0, 0.0)
        self.body = Body(walls, start, BodySettings(), NOISELESS, stream(1, "drive"))
        self.head = StepperHead(FINE)
        self.laser = Laser(
            walls,
            self.body,
            self.head,
            settings=settings or LaserSettings(),
            noise=noise,
            randomness=stream(1, "rangefinder"),
        )
        self.laser.switch(on=True)
        self.now_us = 0

    def shoot(self, pan_rad: float = 0.0, tilt_rad: float = 0.0) -> ShotAnswer:
        self.now_us += 2_000_000
        self.head.advance(self.now_us)
        self.head.aim(pan_rad, tilt_rad)
        self.now_us += 2_000_000
        return self.laser.shoot(self.now_us)


def test_it_measures_along_the_beam_from_body_heading_and_pan() -> None:
    answer = Rig(start=Pose2(1.0, 0.5, 0.3)).shoot(pan_rad=0.2)
    assert answer.status is ShotStatus.OK
    assert answer.range_m == pytest.approx(2.0 / math.cos(0.5), abs=1e-6)
    assert answer.takes_us == 4_000
    assert answer.strength > 0


def test_a_beam_that_starts_off_the_axis_turns_with_the_body() -> None:
    settings = LaserSettings(mount_x_m=0.1, mount_y_m=0.05)
    assert Rig(settings).shoot().range_m == pytest.approx(2.9)
    assert Rig(settings, start=Pose2(0.0, 0.0, math.pi / 2)).shoot(pan_rad=-math.pi / 2).range_m == pytest.approx(3.05)


def test_a_head_mounted_askew_points_elsewhere_than_it_reads() -> None:
    assert Rig(LaserSettings(pan_zero_rad=0.4)).shoot().range_m == pytest.approx(3.0 / math.cos(0.4))
    assert Rig(LaserSettings(tilt_zero_rad=0.1)).shoot().range_m == pytest.approx(3.0 / math.cos(0.1))


def test_a_slanted_beam_is_longer_and_ends_on_the_floor() -> None:
    assert Rig().shoot(tilt_rad=-0.1).range_m == pytest.approx(3.0 / math.cos(0.1))
    assert Rig().shoot(tilt_rad=-0.5).range_m == pytest.approx(0.55 / math.sin(0.5))


def test_a_beam_passes_over_what_is_lower() -> None:
    walls = WallSegments.of([((2.0, -1.0), (2.0, 1.0), 0.5), ((3.0, -1.0), (3.0, 1.0), math.inf)])
    assert Rig(walls=walls).shoot().range_m == pytest.approx(3.0)
    assert Rig(LaserSettings(height_m=0.4), walls=walls).shoot().range_m == pytest.approx(2.0)


def test_what_cannot_be_measured_is_said_and_never_a_number() -> None:
    assert Rig(start=Pose2(2.8, 0.0, 0.0)).shoot() == ShotAnswer(ShotStatus.TOO_NEAR, 0.0, 0, 4_000)
    assert Rig(start=Pose2(-8.0, 0.0, 0.0)).shoot() == ShotAnswer(ShotStatus.OVER_RANGE, 0.0, 0, 4_000)
    assert Rig().shoot(pan_rad=math.pi / 2 + 0.1).status is ShotStatus.OVER_RANGE  # nothing there at all
    rig = Rig()
    rig.laser.switch(on=False)
    assert rig.shoot().status is ShotStatus.LASER_OFF


def test_the_noise_is_what_the_settings_say() -> None:
    rig = Rig(noise=replace(NOISELESS, range_sigma_m=0.02, outlier_share=0.1))
    ranges = [rig.laser.shoot(0).range_m for _ in range(4_000)]
    near = [value for value in ranges if abs(value - 3.0) < 0.1]
    assert statistics.stdev(near) == pytest.approx(0.02, rel=0.1)
    assert statistics.fmean(near) == pytest.approx(3.0, abs=0.002)
    assert 1 - len(near) / len(ranges) == pytest.approx(0.1, abs=0.02)
    assert min(ranges) >= 0.3
    assert max(ranges) <= 6.0


def test_the_bias_is_added() -> None:
    assert Rig(LaserSettings(range_bias_m=0.05)).shoot().range_m == pytest.approx(3.05)


def test_a_shot_sees_body_and_head_at_its_own_moment() -> None:
    rig = Rig()
    rig.body.advance(0)
    rig.body.command(0.3, 0.0)
    assert rig.laser.shoot(2_000_000).range_m == pytest.approx(3.0 - 0.3 * 1.75)


def test_impossible_settings_are_refused() -> None:
    with pytest.raises(ValueError, match="range_min_m"):
        LaserSettings(range_min_m=20.0)
    with pytest.raises(ValueError, match="takes_us"):
        LaserSettings(takes_us=0)
