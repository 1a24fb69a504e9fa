"""The manual page of robotctl, from its own parser: ``manual.py FILE.gz VERSION``."""

import gzip
import sys
from pathlib import Path

from robotd.cli.main import whole_parser


def literal(block: str) -> list[str]:
    """Return lines as they are."""
    escaped = block.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
    return [".nf", *(f"\\&{line}" for line in escaped.splitlines()), ".fi"]


def page(version: str) -> str:
    """Return the page, in the language of man."""
    text = [
        f'.TH ROBOTCTL 1 "" "robotd {version}" "User Commands"',
        ".SH NAME",
        "robotctl \\- talk to robotd",
        ".SH SYNOPSIS",
        ".B robotctl",
        ".I VERB",
        "\\&...",
    ]
    for name, parser in whole_parser():
        text += [f'.SH "{name.upper()}"', *literal(parser.format_help())]
    return "\n".join(text) + "\n"


def main(path: Path, version: str) -> None:
    """Write the page, packed."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(gzip.compress(page(version).encode(), 9, mtime=0))


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2])
