"""Prose in plain English: words that a reader stumbles over are not used, in pages, docstrings or messages."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LET_GO = re.compile(
    r"\b(so many|so much|whoever|nobody knows|bought devices?)\b|\banew\b(?! *[!&=,)])"
    r"|\b(robot|board)s? that (is|are) not there\b|\bData's way\b",
    re.IGNORECASE,
)
"""In their place: a number, this many; who, anyone who; again; not known; vendor device; simulated robot."""
SOURCES = ("robotd", "firmware_proto", "tests", "docs", "systemd", ".github")
ENDINGS = {".py", ".c", ".h", ".md", ".toml", ".yml", ".service", ".rules", ".template"}
FILES = sorted(
    file
    for file in [*ROOT.glob("*.md"), *(file for room in SOURCES for file in (ROOT / room).rglob("*"))]
    if file.suffix in ENDINGS and file != Path(__file__) and file.name != "CHANGELOG.md"
    if not re.match(r"\d{4}-\d\d-\d\d", file.name)  # a benchmark of that day, as it was printed
)


@pytest.mark.parametrize("room", sorted({file.relative_to(ROOT).parts[0] for file in FILES}))
def test_no_word_is_used_that_was_let_go(room: str) -> None:
    found = [
        f"{file.relative_to(ROOT)}:{number}: {match[0]}"
        for file in FILES
        if file.relative_to(ROOT).parts[0] == room
        for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), start=1)
        for match in LET_GO.finditer(line)
    ]
    assert found == []
