"""Logging for a journal: one line each, time left to the journal when it is there.

What others say comes into it through many doors: reasons, names, the words of a device that introduces itself, errors
that quote what they could not read. So whatever a record holds becomes printable here, and a line that is not the
first of its record begins with a mark: nobody can forge a line of the log.
"""

import logging
import os
import sys
from pathlib import Path

from robotd.core.text import printable

LONGEST_LINE = 2000
MOST_LINES = 200
"""Of one record: a traceback may be as deep as the recursion that it tells of."""
CONTINUED = "  | "


class PrintableFormatter(logging.Formatter):
    """Formats a record as lines of letters, within bounds."""

    def format(self, record: logging.LogRecord) -> str:
        """Return the first line, and those of a traceback below it."""
        first, *others = super().format(record).split("\n")
        shown = [printable(line, LONGEST_LINE) for line in others[:MOST_LINES]]
        if len(others) > MOST_LINES:
            shown.append(f"... and {len(others) - MOST_LINES} lines more")
        return f"\n{CONTINUED}".join((printable(first, LONGEST_LINE), *shown))


def log_place() -> str:
    """Return where people find the log of this program."""
    if "JOURNAL_STREAM" in os.environ:
        return "journalctl -u robotd"
    try:
        place = str(Path("/proc/self/fd/2").readlink())
    except OSError:
        place = ""
    return place if place.startswith("/") and not place.startswith("/dev/") else "standard error of robotd"


def configure(level: str) -> None:
    """Send the log to standard error, with a time stamp only where no journal adds its own."""
    in_journal = "JOURNAL_STREAM" in os.environ
    form = "%(levelname)s %(name)s: %(message)s" if in_journal else "%(asctime)s %(levelname)-7s %(name)s: %(message)s"
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(PrintableFormatter(form))
    # By force: a library that was imported before may have set up a log of its own.
    logging.basicConfig(level=level.upper(), handlers=[handler], force=True)
