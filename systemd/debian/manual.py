"""The manual page of robotctl, from its own parser: ``manual.py FILE.gz VERSION``."""

import gzip
import sys
from pathlib import Path

from robotd.cli.main import whole_parser

path, version = Path(sys.argv[1]), sys.argv[2]
text = [
    f'.TH ROBOTCTL 1 "" "robotd {version}" "User Commands"',
    ".SH NAME",
    "robotctl \\- talk to robotd",
    ".SH SYNOPSIS",
]
text += [".B robotctl", ".I VERB", "..."]


def literal(block: str) -> list[str]:
    """Return lines as they are."""
    escaped = block.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
    return [".nf", *(f"\\&{line}" for line in escaped.splitlines()), ".fi"]


for name, parser in whole_parser():
    text += [f'.SH "{name.upper()}"', *literal(parser.format_help())]
path.parent.mkdir(parents=True, exist_ok=True)
path.write_bytes(gzip.compress(("\n".join(text) + "\n").encode(), 9, mtime=0))
