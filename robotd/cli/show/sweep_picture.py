"""A sweep on a terminal, seen from above: the robot in the middle, ahead to the right."""

import shutil

from rich.console import Console
from rich.text import Text

from robotd.cli.show.half_blocks import Ink, can_draw_blocks, draw, shrink
from robotd.core.pose import IDENTITY
from robotd.core.reading import Sweep
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings

_WIDEST = 100
_BESIDE_M = 0.5
_CELLS_MAX = 400
"""Along a side: more are not seen on a terminal."""


def sweep_picture(sweep: Sweep, console: Console) -> Text:
    """Return what a sweep says of the ground about the robot, robot frame, as wide as the console is."""
    ranges_m = [reading.range_m for reading in sweep.readings if reading.range_m is not None]
    far_m = max(ranges_m, default=0.0) + _BESIDE_M
    settings = GridSettings(resolution_m=max(0.05, 2.0 * far_m / _CELLS_MAX), rows=1, cols=1)
    grid = OccupancyGrid(settings.spec_covering([(-far_m, -far_m), (far_m, far_m)], 0.0), settings=settings)
    grid.insert(sweep, IDENTITY)
    columns = min(shutil.get_terminal_size().columns, _WIDEST)
    ink = Ink(colour=bool(console.is_terminal and console.color_system), blocks=can_draw_blocks(console.encoding))
    return draw(shrink(grid.spec, grid.cells, columns), ink, robot=IDENTITY)
