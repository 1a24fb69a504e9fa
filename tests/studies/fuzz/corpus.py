"""Inputs worth keeping, a line of hexadecimal digits each, in one file for each parser."""

from collections.abc import Iterable
from pathlib import Path

DIRECTORY = Path(__file__).parent / "corpus"
ENTRIES_MAX = 60
"""The shortest are kept; they find most of what the rest would."""


def load(name: str) -> list[bytes]:
    """Return what was kept for a parser."""
    file = DIRECTORY / f"{name}.hex"
    return [bytes.fromhex(line) for line in file.read_text(encoding="ascii").splitlines()] if file.exists() else []


def save(name: str, inputs: Iterable[bytes]) -> None:
    """Keep these, and only these."""
    kept = sorted(set(inputs), key=lambda data: (len(data), data))[:ENTRIES_MAX]
    DIRECTORY.mkdir(exist_ok=True)
    (DIRECTORY / f"{name}.hex").write_text("".join(f"{data.hex()}\n" for data in kept), encoding="ascii")
