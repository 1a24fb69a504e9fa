"""Values changed in a text: it says them, and all else stays, comments included."""

import tomllib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.config import loads
from robotd.core.errors import ConfigError
from robotd.toml.edit import with_values

SHIPPED = (Path(__file__).parents[3] / "systemd" / "robotd.toml").read_text()
VALUES = {"drive": {"counts_per_m": 27_100.5}, "pantilt": {"pan_zero_rad": -0.02, "backlash_rad": 0.09}}


def test_a_line_is_set_and_the_old_one_stays_as_a_comment() -> None:
    text = "[drive]\n# ours\ncounts_per_m = 25000.0  # by chalk\ncounts_per_rad = 4096.0\n"
    assert with_values(text, {"drive": {"counts_per_m": 27100.5}}, "before") == (
        "[drive]\n# ours\n# counts_per_m = 25000.0  # by chalk  # before\n"
        "counts_per_m = 27100.5\ncounts_per_rad = 4096.0\n"
    )


def test_what_is_not_there_is_put_where_it_belongs() -> None:
    text = with_values("[drive]\nport = 'a'\n", VALUES)
    assert tomllib.loads(text) == {
        "drive": {"port": "a", "counts_per_m": 27_100.5},
        "pantilt": {"pan_zero_rad": -0.02, "backlash_rad": 0.09},
    }


def test_the_shipped_file_loses_no_line() -> None:
    changed = with_values(SHIPPED, VALUES, "before")
    assert loads(changed).drive.counts_per_m == 27_100.5
    stripped = [line.removeprefix("# ").split("  # before")[0] for line in changed.splitlines()]
    for line in SHIPPED.splitlines():
        assert line.removeprefix("# ") in stripped


@given(st.floats(-3.0, 3.0), st.floats(100.0, 1e6))
def test_it_says_what_was_set_however_often(zero_rad: float, counts: float) -> None:
    once = with_values(SHIPPED, VALUES)
    twice = tomllib.loads(with_values(once, {"drive": {"counts_per_m": counts}, "pantilt": {"pan_zero_rad": zero_rad}}))
    assert (twice["drive"]["counts_per_m"], twice["pantilt"]["pan_zero_rad"]) == (counts, zero_rad)
    assert twice["pantilt"]["backlash_rad"] == 0.09


@pytest.mark.parametrize("text", ["drive = { counts_per_m = 25000.0 }\n", "[drive]\ncounts_per_m =\\\n 1.0\n"])
def test_what_cannot_be_set_line_by_line_is_refused(text: str) -> None:
    with pytest.raises((ConfigError, tomllib.TOMLDecodeError)):
        with_values(text, {"drive": {"counts_per_m": 27_100.5}})
