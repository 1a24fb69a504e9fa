"""A name says which one it is, so that it can be found: one file of a name, and one class."""

import ast
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
FILES = sorted(file for room in ("robotd", "firmware_proto") for file in (ROOT / room).rglob("*.py"))
OF_EVERY_ROOM = {"__init__", "__main__", "settings", "program"}
"""What a room has as a part of it; it is looked for with its room."""
OF_BOTH_SIDES = {"catalogue"}
"""Adapters and their emulators are listed alike: a row a dialect."""
ON_BOTH_SIDES_OF_A_WIRE = {
    *("AimReadback", "Arm", "Clear", "Disarm", "Done", "ErrorCode", "Fault", "Hello", "Message", "Ping", "Shot"),
    *("LoopClosed", "LoopHeld", "Reconciled", "Scan", "Stop", "StopPlaced", "Wire"),
}
"""The same thing as a board, a client or the head says it, and as it is meant on this side."""
FAR_APART = {"Ground", "Host", "Subscription"}
"""Rooms that never meet: a protocol of each, or a type of its own."""


def twice(named: Iterator[tuple[str, Path]]) -> dict[str, list[str]]:
    """Return the names that stand in more than one file, with the files."""
    places = defaultdict(list)
    for name, file in named:
        places[name].append(str(file.relative_to(ROOT)))
    return {name: files for name, files in places.items() if len(files) > 1}


def classes() -> Iterator[tuple[str, Path]]:
    """Yield each class that other files may import."""
    for file in FILES:
        for node in ast.parse(file.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                yield node.name, file


def test_no_two_files_of_the_package_have_one_name() -> None:
    assert twice((file.stem, file) for file in FILES).keys() <= OF_EVERY_ROOM | OF_BOTH_SIDES


def test_no_two_classes_have_one_name_but_what_is_one_thing_on_two_sides() -> None:
    found = twice(classes())
    assert {name: files for name, files in found.items() if name not in ON_BOTH_SIDES_OF_A_WIRE | FAR_APART} == {}
    assert found.keys() >= FAR_APART | ON_BOTH_SIDES_OF_A_WIRE, "what is one again need not be excepted"
