"""Short recordings of one room: no two of them alike, and made in no time."""

import random
from pathlib import Path

from tests.support.recorded_room import drive_lines

SCANS = 60
_DRIVEN = 2000


def write_recordings(directory: Path, count: int) -> list[Path]:
    """Write this many logs, each of scans drawn from a long drive, in its order."""
    drawn = random.Random(0)
    drive = drive_lines(_DRIVEN if count > 10 else 4 * SCANS)
    directory.mkdir(parents=True, exist_ok=True)
    logs = [directory / f"{number:05}.log" for number in range(count)]
    for log in logs:
        log.write_text("\n".join(drive[index] for index in sorted(drawn.sample(range(len(drive)), SCANS))))
    return logs
