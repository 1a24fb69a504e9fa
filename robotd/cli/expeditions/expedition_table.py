"""What became of robots that explored, a line a world, as a table for people."""

from collections.abc import Sequence
from itertools import groupby
from statistics import median

from rich.table import Table

from robotd.cli.expeditions.expedition import Expedition
from robotd.cli.show.terminal import out


def print_expeditions(done: Sequence[Expedition]) -> None:
    """Print the figures of each world; medians, and the worst."""
    headers = (
        "world",
        "ended by\nitself",
        "seen\n[%]",
        "worst pose\n[mm]",
        "stops",
        "of a tour",
        "way\n[m]",
        "of a tour",
        "time\n[s]",
    )
    table = Table(*headers, box=None, header_style="bold")
    for column in table.columns[1:]:
        column.justify = "right"
    for world, group in groupby(done, key=lambda one: one.world):
        robots = list(group)
        table.add_row(
            world,
            f"{sum(one.ended_by_itself for one in robots)} of {len(robots)}",
            f"{100 * median(one.seen_share for one in robots):.1f}, {100 * min(one.seen_share for one in robots):.1f}",
            f"{1000 * median(one.worst_m for one in robots):.0f}, {1000 * max(one.worst_m for one in robots):.0f}",
            f"{median(one.stops for one in robots):g}, {max(one.stops for one in robots)}",
            f"{robots[0].tour_stops}",
            f"{median(one.way_m for one in robots):.1f}, {max(one.way_m for one in robots):.1f}",
            f"{robots[0].tour_way_m:.1f}",
            f"{median(one.took_s for one in robots):.0f}, {max(one.took_s for one in robots):.0f}",
        )
    out().print(table)
    out().print("  of several robots the median, then the worst; the tour is of somebody who knows the map")
