"""Every mistake in a configuration is named in one line: file, line, key, what is wrong, what was meant."""

import enum
from dataclasses import dataclass, field

import pytest

from robotd.core.errors import ConfigError
from robotd.toml.settings_reader import read_text


class Pace(enum.StrEnum):
    SLOW = "slow"
    BRISK = "brisk"


@dataclass(frozen=True, slots=True)
class Wheel:
    port: str
    timeout_s: float = 0.5
    counts_per_m: float = 1000.0
    retries: int = 3
    spare: bool = False
    pace: Pace = Pace.SLOW
    name: str | None = None

    def __post_init__(self) -> None:
        if self.timeout_s <= 0.0:
            raise ValueError(f"timeout_s must be positive, got {self.timeout_s:g}")
        if self.retries < 0:
            raise ValueError(f"retries must not be negative, got {self.retries}")


@dataclass(frozen=True, slots=True)
class Laser:
    range_min_m: float = 0.1
    range_max_m: float = 9.0
    corners_m: tuple[tuple[float, float], ...] = ()
    offset_m: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        if self.range_min_m >= self.range_max_m:
            raise ValueError(f"range_min_m must be below range_max_m, got {self.range_min_m} and {self.range_max_m}")


@dataclass(frozen=True, slots=True)
class Robot:
    wheel: Wheel
    laser: Laser = field(default_factory=Laser)
    spare_laser: Laser = field(default_factory=lambda: Laser(range_max_m=4.0))

    def __post_init__(self) -> None:
        if self.laser.range_max_m > 100.0 * self.wheel.timeout_s:
            raise ValueError("laser.range_max_m is more than wheel.timeout_s allows")


def read(text: str) -> Robot:
    return read_text(Robot, text, "r.toml")


WHEEL = '[wheel]\nport = "/dev/x"\n'


def test_a_table_becomes_a_dataclass_and_the_rest_keeps_its_default() -> None:
    text = WHEEL + 'timeout_s = 2\npace = "brisk"\n[laser]\ncorners_m = [[0, 1.5], [2, 3]]\noffset_m = [1, -1]\n'
    assert read(text) == Robot(
        Wheel("/dev/x", timeout_s=2.0, pace=Pace.BRISK), Laser(corners_m=((0.0, 1.5), (2.0, 3.0)), offset_m=(1.0, -1.0))
    )


def test_whole_numbers_become_floats_where_a_float_is_due() -> None:
    assert isinstance(read(WHEEL + "timeout_s = 2").wheel.timeout_s, float)


def test_optional_values_are_none_until_set() -> None:
    assert read(WHEEL).wheel.name is None
    assert read(WHEEL + 'name = "left"').wheel.name == "left"


def test_a_section_takes_what_it_leaves_out_from_its_own_default() -> None:
    assert read(WHEEL + "[spare_laser]\nrange_min_m = 1").spare_laser == Laser(range_min_m=1.0, range_max_m=4.0)


BAD = [
    ("retires = 1", "r.toml:3: wheel.retires: unknown key; did you mean retries?"),
    ("zzz = 1", "r.toml:3: wheel.zzz: unknown key"),
    ("timeout_ms = 500", "r.toml:3: wheel.timeout_ms: wrong unit: expected timeout_s, in seconds"),
    ("timeout = 1", "r.toml:3: wheel.timeout: no unit: expected timeout_s, in seconds"),
    (
        "counts_per_mm = 1",
        "r.toml:3: wheel.counts_per_mm: wrong unit: expected counts_per_m, per metre",
    ),
    ('timeout_s = "1"', "r.toml:3: wheel.timeout_s: expected a number, got a string"),
    ("timeout_s = true", "r.toml:3: wheel.timeout_s: expected a number, got true"),
    ("timeout_s = [1]", "r.toml:3: wheel.timeout_s: expected a number, got a list"),
    ("timeout_s = 2020-01-01", "r.toml:3: wheel.timeout_s: expected a number, got a date or time"),
    ("timeout_s = nan", "r.toml:3: wheel.timeout_s: must be finite, got nan"),
    ("timeout_s = -inf", "r.toml:3: wheel.timeout_s: must be finite, got -inf"),
    ("timeout_s = -1", "r.toml:3: wheel.timeout_s: must be positive, got -1"),
    ("retries = 1.5", "r.toml:3: wheel.retries: expected a whole number, got the number 1.5"),
    ("retries = false", "r.toml:3: wheel.retries: expected a whole number, got false"),
    ("spare = 1", "r.toml:3: wheel.spare: expected true or false, got the number 1"),
    ("name = 7", "r.toml:3: wheel.name: expected a string, got the number 7"),
    ('pace = "slwo"', 'r.toml:3: wheel.pace: expected one of slow, brisk; got "slwo"; did you mean slow?'),
    ("pace = 1", "r.toml:3: wheel.pace: expected one of slow, brisk; got the number 1"),
    ("[lazer]\nrange_max_m = 1", "r.toml:3: lazer: unknown section; did you mean laser?"),
    ("[laser]\nrange_min_m = 10", "r.toml:4: laser.range_min_m: must be below range_max_m, got 10.0 and 9.0"),
    (
        "[laser]\nrange_max_m = 0.05",
        "r.toml:4: laser.range_max_m: range_min_m must be below range_max_m, got 0.1 and 0.05",
    ),
    ("[laser]\noffset_m = [1]", "r.toml:4: laser.offset_m: expected a list of 2, got 1"),
    ("[laser]\noffset_m = 1", "r.toml:4: laser.offset_m: expected a list, got the number 1"),
    ('[laser]\ncorners_m = [[1, 2],\n [1, "2"]]', "r.toml:4: laser.corners_m[1][1]: expected a number, got a string"),
    ("[laser]\nrange_max_m = 60", "r.toml:4: laser.range_max_m: is more than wheel.timeout_s allows"),
    ("[wheel.x]\ny = 1", "r.toml:3: wheel.x: unknown key"),
    ("retries = ", "r.toml:3: not TOML: invalid value"),
    ("retries = 1\nretries = 2", "r.toml:4: not TOML: cannot overwrite a value"),
    ('name = "', "r.toml:3: not TOML: unterminated string"),
]


@pytest.mark.parametrize(("added", "complaint"), BAD)
def test_one_mistake_is_one_line(added: str, complaint: str) -> None:
    with pytest.raises(ConfigError) as caught:
        read(WHEEL + added)
    assert [str(problem) for problem in caught.value.problems] == [complaint]


def test_a_section_must_be_a_table() -> None:
    with pytest.raises(ConfigError, match=r"^r.toml:1: wheel: expected a table, got the number 1$"):
        read("wheel = 1")


def test_a_required_key_that_is_missing_is_laid_at_its_section() -> None:
    with pytest.raises(ConfigError, match=r"^r.toml:2: wheel.port: required key is missing$"):
        read("\n[wheel]\nretries = 2")
    with pytest.raises(ConfigError, match=r"^r.toml: wheel.port: required key is missing$"):
        read("")


def test_all_mistakes_of_a_file_are_reported_in_the_order_of_their_lines() -> None:
    with pytest.raises(ConfigError) as caught:
        read("[wheel]\nretries = -1\ntimeout_s = -2\nspare = 0\n[laser]\nrang_max_m = 3\n[moon]\n")
    assert str(caught.value).splitlines() == [
        "r.toml:1: wheel.port: required key is missing",
        "r.toml:4: wheel.spare: expected true or false, got the number 0",
        "r.toml:6: laser.rang_max_m: unknown key; did you mean range_max_m?",
        "r.toml:7: moon: unknown section",
    ]


def test_one_impossible_value_does_not_hide_the_next() -> None:
    with pytest.raises(ConfigError) as caught:
        read(WHEEL + "retries = -1\ntimeout_s = -2")
    assert str(caught.value).splitlines() == [
        "r.toml:3: wheel.retries: must not be negative, got -1",
        "r.toml:4: wheel.timeout_s: must be positive, got -2",
    ]


def test_a_value_that_could_not_be_read_is_not_complained_about_twice() -> None:
    with pytest.raises(ConfigError) as caught:
        read(WHEEL + '[laser]\nrange_min_m = "x"\nrange_max_m = 0.05')
    assert str(caught.value) == "r.toml:4: laser.range_min_m: expected a number, got a string"
