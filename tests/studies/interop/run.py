"""``make interop``: each form of other programs, written and read, with what comes back held against what went.

A line a form: what was written, how large it is, how many things it holds, how far the worst of them is from what it
was, and whose program read it besides ours.
"""

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from rich.console import Console
from rich.table import Table

from tests.studies.interop import maps_of_others, recordings_of_ours, scans_of_others
from tests.studies.interop.trip import Trip
from tests.support.recorded_session import record_session


def trips(directory: Path) -> Iterator[Trip]:
    """Yield each way in or out, as it was tried."""
    yield from maps_of_others.trips(directory)
    yield from scans_of_others.trips(directory)
    recorded = record_session(directory)
    yield from recordings_of_ours.trips(recorded, directory)


def main() -> int:
    """Print the table; 1 if anything came back otherwise than it is promised."""
    table = Table("form", "way", "bytes", "holds", "worst difference", "allowed", "read by", box=None, header_style="")
    with tempfile.TemporaryDirectory(prefix="robotd-interop-") as directory:
        tried = list(trips(Path(directory)))
    for trip in tried:
        verdict = "" if trip.is_true else "  BEYOND IT"
        allowed = f"{trip.allowed:g} {trip.unit}{verdict}"
        table.add_row(
            trip.form, trip.way, f"{trip.size_bytes}", trip.holds, f"{trip.worst:.2g} {trip.unit}", allowed, trip.reader
        )
    Console(width=160).print(table)
    return 0 if all(trip.is_true for trip in tried) else 1


if __name__ == "__main__":
    sys.exit(main())
