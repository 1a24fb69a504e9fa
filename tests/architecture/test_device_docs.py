"""The table of devices names every dialect there is, with the line it usually has, and no other."""

import re
from dataclasses import fields
from pathlib import Path

import pytest

from robotd.hardware.devices.dialects import DIALECTS
from robotd.hardware.devices.settings import DriveSettings, PanTiltSettings, RangefinderSettings

PAGE = Path(__file__).parents[2] / "docs" / "devices.md"
SHARED = {"drive": DriveSettings, "pantilt": PanTiltSettings, "rangefinder": RangefinderSettings}
SECTIONS = {"drive": "Base", "pantilt": "Pan/tilt", "rangefinder": "Rangefinder"}


def rows(device: str) -> dict[str, str]:
    """Return the usual line of each dialect in the table of a device."""
    section = PAGE.read_text(encoding="utf-8").split(f"## {SECTIONS[device]}\n")[1].split("\n## ")[0]
    found = {}
    for line in section.splitlines():
        if line.startswith("| `") and not line.startswith("| `dialect`"):
            words, _, usual, *_ = (cell.strip() for cell in line.strip("|").split("|"))
            found.update(dict.fromkeys(re.findall(r"`([\w-]+)`", words), usual))
    return found


@pytest.mark.parametrize("device", SECTIONS)
def test_every_dialect_is_in_the_table_with_its_line(device: str) -> None:
    said = rows(device)
    assert set(said) == set(DIALECTS[device])
    for name, dialect in DIALECTS[device].items():
        assert said[name].startswith("none" if dialect.line is None else str(dialect.line)), name


@pytest.mark.parametrize("device", SECTIONS)
def test_every_option_of_a_dialect_is_in_its_row(device: str) -> None:
    page = PAGE.read_text(encoding="utf-8").split(f"## {SECTIONS[device]}\n")[1].split("\n## ")[0]
    for name, dialect in DIALECTS[device].items():
        [row] = (line for line in page.splitlines() if f"`{name}`" in line.partition("|")[2].partition("|")[0])
        own = {field.name for field in fields(dialect.options)} - {field.name for field in fields(SHARED[device])}
        assert {option for option in own if f"`{option}`" not in row} == set(), name


def test_every_hazard_is_on_the_page() -> None:
    words = " ".join(PAGE.read_text(encoding="utf-8").split())
    hazards = {hazard for rows in DIALECTS.values() for dialect in rows.values() for hazard in dialect.hazards}
    assert {hazard for hazard in hazards if hazard.rstrip(".") not in words} == set()
