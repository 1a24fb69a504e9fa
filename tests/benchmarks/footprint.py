"""``python -m tests.benchmarks.footprint SIDE``: the memory that making a map ready and localizing on it takes (Linux).

Peaks are above what the process had before: the interpreter, its libraries, and the masks of the map itself.
"""

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from robotd.grid.readings import Readings
from robotd.localization.even_headings import even_headings
from robotd.localization.reference.count_all import count_all
from robotd.localization.search.bounded_search import best_poses
from tests.benchmarks.sections.scaling import site_of

_STATUS, _RESET = Path("/proc/self/status"), Path("/proc/self/clear_refs")
_HEADINGS_COUNTED = 30


def main() -> None:
    """Print one line."""
    site = site_of(int(sys.argv[1]), 1)
    sweep, obstacles = site.sweeps[0], site.obstacles
    headings_rad = np.array(even_headings(300))
    assert obstacles.free.any()
    search = peak_mib(lambda: best_poses(site.search_map, Readings.of(sweep), headings_rad, slack=45, least_rank=150))
    count = peak_mib(lambda: count_all(site.prepared, Readings.of(sweep), even_headings(_HEADINGS_COUNTED)))
    print(f"peak {search:.0f} MiB to search, {count:.0f} MiB to count {_HEADINGS_COUNTED} headings")


def peak_mib(function: Callable[[], object]) -> float:
    """Return by how much the process grew at most."""
    _RESET.write_text("5")
    before = _mib("VmRSS")
    function()
    return _mib("VmHWM") - before


def _mib(name: str) -> float:
    line = next(line for line in _STATUS.read_text().splitlines() if line.startswith(f"{name}:"))
    return int(line.split()[1]) / 1024


if __name__ == "__main__":
    main()
