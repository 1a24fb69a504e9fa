"""Maps of map_server, out and in again: pictures as Pillow sees them, placement as PyYAML reads it."""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray
from PIL import Image

from robotd.core.grid_spec import GridSpec
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION
from robotd.interop.map_server import export_map
from robotd.interop.read_map import read_map
from tests.studies.interop.trip import Trip, size_bytes

_ORIGIN_M = (-math.pi, 1.0 / 3.0)
"""Numbers that no short decimal has."""
_PER_CENT = 2
"""Values of 255 by which a cell may be off where per cent are told."""


def trips(directory: Path) -> Iterator[Trip]:
    """Yield what becomes of all 256 values in each mode, and of the placement."""
    cells = np.arange(256 * 300).reshape(256, 300).astype(np.uint8)
    grid = OccupancyGrid(GridSpec(0.05, *_ORIGIN_M, cells.shape), cells)
    for mode in ("scale", "raw", "trinary"):
        place = directory / f"map-{mode}"
        place.mkdir()
        for name, content in export_map(grid, "map", mode).items():
            (place / name).write_bytes(content)
        told = yaml.safe_load((place / "map.yaml").read_text())
        with Image.open(place / told["image"]) as picture:
            assert picture.size == (300, 256)
        again = read_map(place / "map.yaml").grid
        readers, holds = "Pillow, PyYAML, ours", f"{cells.size} cells, {told['image']}"
        if mode == "trinary":
            worst, allowed, unit = _others(again.cells, cells), 0, "sure cells"
        else:
            worst, allowed, unit = _farthest(again.cells, cells), _PER_CENT * (mode == "raw"), "of 255"
        yield Trip(f"map_server {mode}", "out, in", size_bytes(place), holds, worst, allowed, unit, readers)
        told_m, again_m = told["origin"], (again.spec.origin_x_m, again.spec.origin_y_m, 0.0)
        off_m = max(
            abs(one - sent) for came in (told_m, again_m) for one, sent in zip(came, (*_ORIGIN_M, 0), strict=True)
        )
        form, size = f"map_server {mode}, placement", size_bytes(place / "map.yaml")
        yield Trip(form, "out, in", size, "1 origin", off_m, 0.0, "m", "PyYAML, ours")


def _farthest(came: NDArray[np.uint8], sent: NDArray[np.uint8]) -> int:
    """Return the largest difference of two cells."""
    return int(np.abs(came.astype(int) - sent).max())


def _others(came: NDArray[np.uint8], sent: NDArray[np.uint8]) -> int:
    """Return how many cells are of another kind, of those that are surely occupied or vacant, or unknown."""
    sure = (sent >= 166) | (sent <= 49) | (sent == NO_INFORMATION)
    kinds = [np.sign(one.astype(int) - NO_INFORMATION)[sure] for one in (came, sent)]
    return int((kinds[0] != kinds[1]).sum())
