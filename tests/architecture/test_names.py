"""The name of a file says which file it is: one name, one file, so that it can be found."""

from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).parents[2]
OF_EVERY_ROOM = {"__init__", "__main__", "settings", "program"}
"""What a room has as a part of it; it is looked for with its room."""
OF_BOTH_SIDES = {"catalogue"}
"""Adapters and their emulators are listed alike: a row a dialect."""


def test_no_two_files_of_the_package_have_one_name() -> None:
    files = defaultdict(list)
    for room in ("robotd", "firmware_proto"):
        for file in sorted((ROOT / room).rglob("*.py")):
            files[file.stem].append(str(file.relative_to(ROOT)))
    twice = {name: places for name, places in files.items() if len(places) > 1}
    assert {name: places for name, places in twice.items() if name not in OF_EVERY_ROOM | OF_BOTH_SIDES} == {}
