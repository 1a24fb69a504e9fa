"""What mapping a log came to, as a table for people."""

import math
from typing import Any

from rich.table import Table
from rich.text import Text

from robotd.cli.show.terminal import out

_WORDS = {
    "raw odometry": "raw odometry",
    "front end alone": "stops placed, no loop closed",
    "located": "loops closed; scans between stops located on the map",
    "interpolated": "the same, scans between stops by odometry",
}


def print_survey(name: str, report: dict[str, Any]) -> None:
    """Print the figures of one log; ``report`` as programs get it."""
    title = f"{name}: {report['stops']} stops of {report['scans']} scans, {report['relations']} relations"
    out().print(Text(title, style="bold"))
    table = Table("error against the relations", "mean [m]", "+-", "most", "mean [deg]", "+-", "most", box=None)
    for column in table.columns[1:]:
        column.justify = "right"
    for key, errors in report["errors"].items():
        metres, radians = errors["metres"], errors["radians"]
        table.add_row(
            f"  {_WORDS[key]}",
            *(f"{metres[of]:.{places}f}" for of, places in _COLUMNS),
            *(f"{math.degrees(radians[of]):.{places - 1}f}" for of, places in _COLUMNS),
        )
    out().print(table)
    out().print("  " + ", ".join(f"{count} {what}" for what, count in sorted(report["outcomes"].items())))
    out().print("  processor time: " + ", ".join(f"{what} {_time(time_s)}" for what, time_s in report["cpu_s"].items()))


def _time(time_s: float) -> str:
    return f"{time_s:.1f} s" if time_s >= 1.0 else f"{1000.0 * time_s:.0f} ms"


_COLUMNS = (("mean", 4), ("deviation", 4), ("largest", 2))
