"""The table of devices names every dialect there is, with the line it usually has, and no other."""

import re
from pathlib import Path

import pytest

from robotd.hardware.devices.catalogue import DIALECTS

PAGE = Path(__file__).parents[2] / "docs" / "devices.md"
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
        assert said[name].startswith(str(dialect.line)), name
