"""Every number of the configuration has bounds that a robot can have, and a slip of units is told as one."""

import dataclasses
import math
from collections.abc import Iterator
from typing import Any

import pytest

from robotd.config import Config, loads
from robotd.core.bounds import Within, bounds_of
from robotd.core.errors import ConfigError
from robotd.toml.writer import write_value


def numbers() -> Iterator[tuple[str, str, Any]]:
    """Yield section, key and default of every number in the tree, found by what it holds, not by how it is declared."""
    for section, settings in ((item.name, getattr(Config(), item.name)) for item in dataclasses.fields(Config)):
        for key, value in ((item.name, getattr(settings, item.name)) for item in dataclasses.fields(settings)):
            assert isinstance(value, int | float | str), f"{section}.{key}: this test does not know such a value"
            if type(value) in {int, float}:
                yield section, key, value


def bounds(section: str, key: str) -> Within:
    kind: Any = type(getattr(Config(), section))
    found = bounds_of(kind)
    assert key in found, f"{section}.{key} has no bounds"
    return found[key]


def complaints(text: str) -> list[str]:
    with pytest.raises(ConfigError) as caught:
        loads(text, file="r.toml")
    return [str(problem) for problem in caught.value.problems]


def test_there_are_as_many_numbers_as_there_were_at_least() -> None:
    assert len(list(numbers())) >= 80


@pytest.mark.parametrize(("section", "key", "default"), list(numbers()))
def test_a_number_has_finite_bounds_round_its_default_and_is_refused_outside(
    section: str, key: str, default: float
) -> None:
    within = bounds(section, key)
    assert math.isfinite(within.least)
    assert math.isfinite(within.most)
    assert within.least < within.most
    assert within.complaint(default) is None
    kind = type(default)
    below = 0 if within.either_sign else math.floor(within.least) - 1
    outside = [kind(below), kind(within.most) + kind(1 + within.most), kind(10**15)]
    for value in outside:
        [complaint] = complaints(f"[{section}]\n{key} = {write_value(value)}\n")
        assert complaint.startswith(f"r.toml:2: {section}.{key}: must be "), complaint
        assert f", got {repr(value).removesuffix('.0')}" in complaint


@pytest.mark.parametrize(("section", "key", "default"), list(numbers()))
def test_a_length_a_time_and_an_angle_say_their_unit(section: str, key: str, default: float) -> None:
    unit = bounds(section, key).unit
    for ending, expected in (("_m", "m"), ("_s", "s"), ("_ms", "ms"), ("_rad", "rad"), ("_hz", "Hz"), ("_v", "V")):
        if key.endswith(ending) and "_per_" not in key:
            assert unit == expected


@pytest.mark.parametrize(
    ("section", "line", "complaint"),
    [
        ("driving", "speed_mps = 400", "speed_mps: must be 0.01 to 5 m/s, got 400; mm/s? then 0.4"),
        ("driving", "speed_mps = 40", "speed_mps: must be 0.01 to 5 m/s, got 40; cm/s? then 0.4"),
        ("driving", "turn_radps = 57", "turn_radps: must be 0.01 to 10 rad/s, got 57; deg/s? then 0.995"),
        ("driving", "deceleration_mps2 = 30", "deceleration_mps2: must be 0.01 to 10 m/s^2, got 30; cm/s^2? then 0.3"),
        (
            "driving",
            "deceleration_mps2 = 300",
            "deceleration_mps2: must be 0.01 to 10 m/s^2, got 300; mm/s^2? then 0.3",
        ),
        ("driving", "silence_s = 500", "silence_s: must be 0.01 to 10 s, got 500; ms? then 0.5"),
        ("driving", "gain_hz = 200", "gain_hz: must be 0.1 to 50 Hz, got 200; ms? then 5"),
        ("planning", "robot_radius_m = 300", "robot_radius_m: must be 0.02 to 3 m, got 300; mm? then 0.3"),
        ("planning", "robot_radius_m = 30", "robot_radius_m: must be 0.02 to 3 m, got 30; cm? then 0.3"),
        ("rangefinder", "range_bias_m = 50", "range_bias_m: must be -1 to 1 m, got 50; mm? then 0.05"),
        ("rangefinder", "range_max_m = 6000", "range_max_m: must be 0.05 to 200 m, got 6000; mm? then 6"),
        ("localization", "range_error_m = 75", "range_error_m: must be 0 to 1 m, got 75; mm? then 0.075"),
        (
            "localization",
            "heading_step_rad = 1",
            "heading_step_rad: must be 0.0001 to 0.785398 rad, got 1; deg? then 0.0175",
        ),
        ("localization", "localized_share = 50", "localized_share: must be 0.01 to 1, got 50; %? then 0.5"),
        ("grid", "resolution_m = 50", "resolution_m: must be 0.005 to 2 m, got 50; mm? then 0.05"),
        ("drive", "battery_min_v = 11500", "battery_min_v: must be 0 to 100 V, got 11500; mV? then 11.5"),
        ("drive", "telemetry_ms = 40000", "telemetry_ms: must be 5 to 250 ms, got 40000; us? then 40"),
        (
            "drive",
            "counts_per_m = 3.7e-5",
            "counts_per_m: must be 100 to 1e+08 counts/m, of either sign, got 3.7e-05; m/count? then 2.7e+04",
        ),
    ],
)  # fmt: skip
def test_a_slip_of_units_is_told_with_the_unit_that_was_likely_meant(section: str, line: str, complaint: str) -> None:
    assert complaints(f"[{section}]\n{line}\n") == [f"r.toml:2: {section}.{complaint}"]


def test_whoever_makes_settings_in_a_program_is_told_the_same() -> None:
    driving = Config().driving
    with pytest.raises(ValueError, match=r"^speed_mps must be 0.01 to 5 m/s, got 400; mm/s\? then 0.4$"):
        dataclasses.replace(driving, speed_mps=400)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        (
            "[rangefinder]\nrange_min_m = 7.0",
            "r.toml:2: rangefinder.range_min_m: range_max_m must be above range_min_m, got 6.0 and 7.0",
        ),
        (
            "[driving]\nsilence_s = 0.2",
            (
                "r.toml:2: driving.silence_s: driving.setpoint_ttl_s must be no longer than driving.silence_s,"
                " got 0.4 s and 0.2 s"
            ),
        ),
        (
            "[driving]\nsetpoint_ttl_s = 0.03",
            "r.toml:2: driving.setpoint_ttl_s: must be longer than drive.telemetry_ms, got 0.03 s and 40 ms",
        ),
        (
            "[grid]\nresolution_m = 1.0",
            (
                "r.toml:2: grid.resolution_m: must be no more than twice planning.robot_radius_m, or no robot fits"
                " between obstacles, got 1.0 m and 0.3 m"
            ),
        ),
    ],
)
def test_values_that_do_not_go_together_are_refused(text: str, complaint: str) -> None:
    assert complaints(text) == [complaint]
