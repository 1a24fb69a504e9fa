from dataclasses import replace

import pytest

from robotd.sim.physics.noise import NOISELESS, NoiseSettings, stream


def test_each_device_has_randomness_of_its_own() -> None:
    assert stream(1, "drive").random() == stream(1, "drive").random()
    assert len({stream(1, "drive").random(), stream(1, "laser").random(), stream(2, "drive").random()}) == 3


@pytest.mark.parametrize(
    ("name", "value"), [("range_sigma_m", -0.1), ("outlier_share", 1.0), ("translation_scale_error", 0.7)]
)
def test_noise_that_no_hardware_has_is_refused(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=name):
        replace(NOISELESS, **{name: value})


def test_the_defaults_are_noisy() -> None:
    assert all(getattr(NoiseSettings(), name) > 0.0 for name in NoiseSettings.__slots__)
