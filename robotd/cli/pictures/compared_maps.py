"""Two maps in one picture (needs the extra ``plots``)."""

from pathlib import Path

import numpy as np

from robotd.cli.pictures.sheet import ESTIMATE, INK, PATH, evidence, extent_of, known_box, legend, paper, save
from robotd.grid.map_comparison import FREE, OCCUPIED, MapComparison

_BOTH = (0.13, 0.19, 0.24, 1.0)
_FIRST = (0.85, 0.51, 0.17, 1.0)
_SECOND = (0.04, 0.39, 0.81, 1.0)


def draw_comparison(file: Path, title: str, found: MapComparison) -> None:
    """Draw walls of both dark, of the first alone orange, of the second alone blue; white is free on either."""
    first, second = found.first == OCCUPIED, found.second == OCCUPIED
    ground = np.where((found.first == FREE) | (found.second == FREE), 0, 128).astype(np.uint8)
    known = np.where(first | second, 255, ground).astype(np.uint8)
    axes = paper(title, known_box(found.spec, known), f"cells of {found.spec.resolution_m * 1000:g} mm")
    evidence(axes, found.spec, ground)
    walls = np.zeros((*first.shape, 4))
    walls[first & ~second], walls[second & ~first], walls[first & second] = _FIRST, _SECOND, _BOTH
    axes.imshow(walls, extent=extent_of(found.spec), origin="lower", interpolation="none")
    legend(axes, [("s", "both", INK), ("s", "first alone", PATH), ("s", "second alone", ESTIMATE)])
    save(axes, file)
