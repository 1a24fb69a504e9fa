"""What is gone since, and what has come: the stops of one session of a map held against those of the sessions before.

Each stop says of a cell that beams ran through it, or that one ended in it. A session has a say where two of its stops
looked; what it says against what was said before is a change. Where the map errs by a cell, a wall is beside where it
was: so nothing has changed within reach of what the other session has there, too.
"""

import enum
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.map_stop import MapStop
from robotd.core.rectangle import Rectangle
from robotd.grid.growth import grown_by_disk
from robotd.grid.latest import HIT, PASSED, seen_from
from robotd.localization.places.pieces import connected_components

_LOOKS = 2
"""One look is a wrong range as often as a change."""
_STANDS, _OPEN = 0.5, 0.25
"""The share of the looks that met a cell which ended in it: what stands there has more, what is open less."""
_BESIDE_M = 0.15
"""So near, a wall is the same wall: poses of stops and the rounding of cells."""
_TOGETHER_M = 0.15
"""Cells so near to each other changed together."""
_CELLS_MIN = 3


class Change(enum.StrEnum):
    """What happened in a place."""

    GONE = "gone"
    CAME = "came"


@dataclass(frozen=True, slots=True)
class ChangedPlace:
    """Cells that changed together."""

    change: Change
    box: Rectangle
    """Round them, map frame."""
    cells: int


@dataclass(frozen=True, slots=True, eq=False)
class _Session:
    """What the stops of a session say of each cell, ``bool[rows, cols]``."""

    stands: NDArray[np.bool_]
    open: NDArray[np.bool_]

    @classmethod
    def of(cls, stops: Sequence[MapStop], spec: GridSpec) -> "_Session":
        hits, passes = np.zeros(spec.shape, np.int32), np.zeros(spec.shape, np.int32)
        for stop in stops:
            seen = seen_from(stop, spec)
            hits += seen == HIT
            passes += seen == PASSED
        looks = hits + passes
        return cls(
            (hits >= _LOOKS) & (hits >= _STANDS * looks),
            (passes >= _LOOKS) & (hits <= _OPEN * looks),
        )


def changed_places(before: Sequence[MapStop], since: Sequence[MapStop], spec: GridSpec) -> tuple[ChangedPlace, ...]:
    """Return what the stops since say that those before did not: what is gone, then what has come, by size.

    O(stops x readings x cells a beam).
    """
    old, new = _Session.of(before, spec), _Session.of(since, spec)
    beside_cells = _BESIDE_M / spec.resolution_m
    gone = old.stands & new.open & ~grown_by_disk(new.stands, beside_cells)
    came = new.stands & old.open & ~grown_by_disk(old.stands, beside_cells)
    return (*_places(Change.GONE, gone, spec), *_places(Change.CAME, came, spec))


def _places(change: Change, changed: NDArray[np.bool_], spec: GridSpec) -> list[ChangedPlace]:
    # Grown to be joined: a table is four legs, and a wall that was seen from afar a row of dots.
    joined = np.argwhere(grown_by_disk(changed, _TOGETHER_M / spec.resolution_m))
    if not len(joined):
        return []
    labels = connected_components(np.insert(joined, 0, 0, axis=1), headings=1, wrap=False)
    is_changed = changed[tuple(joined.T)]
    places = []
    for label in range(int(labels.max()) + 1):
        cells = joined[(labels == label) & is_changed]
        if len(cells) >= _CELLS_MIN:
            places.append(ChangedPlace(change, _box(cells, spec), len(cells)))
    return sorted(places, key=lambda place: -place.cells)


def _box(cells: NDArray[np.intp], spec: GridSpec) -> Rectangle:
    (south, west), (north, east) = cells.min(axis=0), cells.max(axis=0) + 1
    x_m, y_m, cell_m = spec.origin_x_m, spec.origin_y_m, spec.resolution_m
    edges = (x_m + west * cell_m, y_m + south * cell_m, x_m + east * cell_m, y_m + north * cell_m)
    return Rectangle(*map(float, edges))
