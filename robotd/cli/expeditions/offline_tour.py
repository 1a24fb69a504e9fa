"""What can be seen of a world, and the stops and the way of somebody who knows it: what exploring is held against."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid import kernels
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.readings import Readings
from robotd.grid.tables import NO_INFORMATION
from robotd.planning.distance_field import distance_field
from robotd.planning.line_of_sight import Cell, touched_cells
from robotd.planning.settings import PlanningSettings
from robotd.planning.traversable import inflated
from robotd.sim.buildings.world import World

_BEAMS = 720
_LATTICE_M = 0.5
_ENOUGH = 0.98
"""Share of what is visible that the stops of the tour must see."""


@dataclass(frozen=True, slots=True, eq=False)
class OfflineTour:
    """Stops that see nearly all, chosen greedily by somebody who knows the map, and a short way through them."""

    visible: NDArray[np.bool_]
    """``bool[rows, cols]``: free ground that is seen from anywhere that the robot can go."""
    stops: int
    way_m: float


def offline_tour(world: World, spec: GridSpec, planning: PlanningSettings, cut_off_m: float) -> OfflineTour:
    """Return the tour of a world, on the cells of a map whose frame is the world's."""
    walls, start = _walls(world, spec), spec.cell_at(world.start.x_m, world.start.y_m)
    cells = spec.resolution_m
    allowed = ~inflated(walls, planning.robot_radius_m / cells, planning.clearance_m / cells)
    ways = distance_field(allowed, start)
    step = round(_LATTICE_M / cells)
    on_lattice = (np.argwhere(np.isfinite(ways[::step, ::step])) * step).tolist()
    places = [start, *((row, col) for row, col in on_lattice)]
    views = _views(walls, spec, places, cut_off_m)
    visible = np.logical_or.reduce(views)
    chosen = [0, *_greedy(views, visible)]
    lengths = np.array([[distance_field(allowed, places[one])[places[other]] for other in chosen] for one in chosen])
    return OfflineTour(visible, len(chosen), _way_through(lengths) * cells)


def _walls(world: World, spec: GridSpec) -> NDArray[np.bool_]:
    """Return the cells that walls run through, ``bool[rows, cols]``."""
    walls = np.zeros(spec.shape, np.bool_)
    for wall in world.wall:
        for start_m, end_m, *_ in wall.segments():
            ends = spec.positions_at(np.array((start_m, end_m)))
            touched = touched_cells((ends[0, 0], ends[0, 1]), (ends[1, 0], ends[1, 1]))
            walls[touched[:, 0], touched[:, 1]] = True
    return walls


def _views(
    walls: NDArray[np.bool_], spec: GridSpec, places: Sequence[Cell], cut_off_m: float
) -> list[NDArray[np.bool_]]:
    """Return the ground that is seen free from each of some cells, ``bool[rows, cols]`` each."""
    bearings_rad = math.tau * np.arange(_BEAMS) / _BEAMS
    beams = np.stack((0.0 * bearings_rad, 0.0 * bearings_rad, np.cos(bearings_rad), np.sin(bearings_rad)), axis=1)
    poses = np.array([(col + 0.5, row + 0.5, 1.0, 0.0) for row, col in places])
    cast = kernels.in_use().cast
    ways, _ = cast.cast_beams(cast.skip_codes(walls, np.zeros_like(walls)), beams, poses, 1)
    views = []
    for place, ways_cells in zip(places, ways, strict=True):
        rows = np.zeros((_BEAMS, 5))
        rows[:, 0], rows[:, 1] = bearings_rad, np.minimum(ways_cells * spec.resolution_m, cut_off_m)
        rows[:, 4] = 1.0
        grid = OccupancyGrid(spec)
        grid.lay(Readings(rows), Pose2(*spec.centre_of(*place), 0.0))
        views.append((grid.cells < NO_INFORMATION) & ~walls)
    return views


def _greedy(views: Sequence[NDArray[np.bool_]], visible: NDArray[np.bool_]) -> list[int]:
    """Return which views beside the first see nearly all of what is visible, each the one that adds most."""
    left, chosen = visible & ~views[0], list[int]()
    while left.sum() > (1.0 - _ENOUGH) * visible.sum():
        chosen.append(int(np.argmax([(view & left).sum() for view in views])))
        left &= ~views[chosen[-1]]
    return chosen


def _way_through(lengths: NDArray[np.float64]) -> float:
    """Return the length of a short way from the first place through all others: the nearest next, then untangled."""
    way, left = [0], set(range(1, len(lengths)))
    while left:
        way.append(min(left, key=lambda place: (lengths[way[-1], place], place)))
        left.remove(way[-1])
    best = _length(lengths, way)
    tangled = True
    while tangled:
        tangled = False
        for begin in range(1, len(way)):
            for end in range(begin + 1, len(way)):
                other = way[:begin] + way[begin : end + 1][::-1] + way[end + 1 :]
                if _length(lengths, other) < best - 1e-9:
                    way, best, tangled = other, _length(lengths, other), True
    return best


def _length(lengths: NDArray[np.float64], way: Sequence[int]) -> float:
    return float(lengths[way[:-1], way[1:]].sum())
