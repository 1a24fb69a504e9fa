"""``make bench``: how long the engine takes, against its NumPy twins and a yardstick of this machine, in one run.

Each section is a file of ``sections`` with a function ``timings``, named in :data:`SECTIONS`. Nothing here passes or
fails.
"""

import argparse
import platform
import subprocess
from collections.abc import Callable, Iterable, Sequence
from datetime import UTC, datetime
from itertools import chain
from pathlib import Path

import numpy as np

from robotd.grid import kernels
from tests.benchmarks import workload
from tests.benchmarks.sections import asking, counting, erring, graph, inserting, refining, scaling, searching, storing
from tests.benchmarks.timing import Timing, copying, yardstick
from tests.support.this_machine import processor

ROOT = Path(__file__).parents[2]

SECTIONS: dict[str, Callable[[], Iterable[Timing]]] = {
    "machine": lambda: [copying()],
    "counting": counting.timings,
    "inserting": inserting.timings,
    "erring": erring.timings,
    "refining": refining.timings,
    "searching": searching.timings,
    "scaling": scaling.timings,
    "storing": storing.timings,
    "graph": graph.timings,
    "asking": asking.timings,
}
"""In the order of the report, by the name that ``--only`` takes."""

_HEADER = "| what | median | 10 - 90 % | least | ratio | goal | runs | |\n|---|---|---|---|---|---|---|---|"


def page_of(names: Sequence[str]) -> str:
    """Run sections, print their lines as they come, and return the page of the report."""
    lines = [_introduction()]
    for name in names:
        measure = yardstick()
        lines += ["", f"## {name.capitalize()}", "", _HEADER]
        print("\n".join(lines[-4:]))
        for timing in chain((measure,), SECTIONS[name]()):
            lines.append(timing.row(measure.least_s))
            print(lines[-1], flush=True)
    return "\n".join(lines) + "\n"


def _introduction() -> str:
    return (
        f"# Benchmarks of {datetime.now(UTC):%Y-%m-%d}\n\n"
        f"Commit {commit()}; {processor()}, Python {platform.python_version()}, NumPy {np.__version__}; "
        f"{kernels.in_use().about}.\n"
        f"Written by `make bench`. {workload.__doc__} Cut-off {workload.CUT_OFF_M} m, error radius "
        f"{workload.ERROR_RADIUS_CELLS} cells, seeds 0 and 1.\n\n"
        "Times in milliseconds. The ratio is the least time to the least of the section's yardstick. The goal is what\n"
        "the median should not exceed on the reference machine, two cores. Other programs may have been running: the\n"
        "least time is the one to compare."
    )


def commit() -> str:
    """Return the commit that is measured, ``+`` if the files are not quite its."""
    show = subprocess.run(
        ["git", "describe", "--always", "--dirty=+"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    return show.stdout.strip() or "unknown"


def main() -> None:
    """Print the report, and write it if it is whole."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", nargs="+", choices=SECTIONS, metavar="SECTION", help="these, and write nothing")
    parser.add_argument(
        "--out", type=Path, default=ROOT / "docs" / "benchmarks", help="directory (default: %(default)s)"
    )
    arguments = parser.parse_args()
    page = page_of(arguments.only or tuple(SECTIONS))
    if arguments.only:
        return
    out: Path = arguments.out
    out.mkdir(parents=True, exist_ok=True)
    file = out / f"{datetime.now(UTC):%Y-%m-%d}.md"
    file.write_text(page)
    print(f"written to {file}")


if __name__ == "__main__":
    main()
