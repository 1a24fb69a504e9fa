"""A scanner that hangs upside down is logged as any other: CARMEN's driver has turned its ranges round already."""

import pytest

from robotd.logs.carmen import parse_carmen
from tests.support.carmen_room import assert_the_room_is_seen, flaser, robotlaser

NAMES = ("laser_front_laser_flipped", "front_laser_flipped", "laser_laser1_flipped", "laser1_flipped")
REAR = ("laser_rear_laser_flipped", "laser_laser2_flipped")


@pytest.mark.parametrize("value", ["1", "on", "yes"])
@pytest.mark.parametrize("lines", [flaser(), robotlaser()], ids=["FLASER", "ROBOTLASER1"])
@pytest.mark.parametrize("name", NAMES)
def test_its_ranges_are_taken_as_they_are_and_that_is_said(name: str, lines: list[str], value: str) -> None:
    log = parse_carmen([f"PARAM {name} {value} h 0", *lines])
    assert_the_room_is_seen(log)
    assert [remark for remark in log.remarks() if "upside down" in remark]


@pytest.mark.parametrize("name", REAR)
def test_so_are_those_of_a_rear_one(name: str) -> None:
    log = parse_carmen([f"PARAM {name} 1 h 0", *flaser("RLASER")])
    assert_the_room_is_seen(log)
    assert "upside down" in "".join(log.remarks())


@pytest.mark.parametrize("setting", [*(f"{name} {value}" for name in NAMES for value in ("0", "off")), f"{REAR[0]} 1"])
def test_one_that_stands_upright_needs_no_remark(setting: str) -> None:
    assert not list(parse_carmen([f"PARAM {setting} h 0", *flaser()]).remarks())
