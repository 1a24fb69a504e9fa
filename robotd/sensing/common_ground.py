"""The ground that is free wherever the robot may be, as it lies to the robot: what every place allows, and no more.

The robot does not know where it stands, so its ground is the map as seen from each place where it may stand, laid on
each other. A way through it is free under all of them.
"""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.planning.distance_field import distance_field
from robotd.planning.line_of_sight import Cell, centre_of, pulled_straight, touched_cells
from robotd.planning.path import descent
from robotd.planning.traversable import inflated
from robotd.sensing.rivals import Rival

Point = tuple[float, float]
_REACH_M = 10.0
"""To each side: farther no way is sought."""
_LEAVING_M = 0.15
"""The robot stands where it stands: what it would touch so near to its start is not asked."""
_CLEAR_FROM_M = 0.4
"""From here on a way keeps the clearance in any case; before it, not where the robot stands nearer to a wall itself."""


@dataclass(frozen=True, eq=False)
class Room:
    """Where the robot's centre may be."""

    spec: GridSpec
    obstacles: NDArray[np.bool_]
    """``bool[rows, cols]``; so is all that lies outside."""
    robot_m: float
    """Radius of its disk."""
    clearance_m: float

    @cached_property
    def tight(self) -> NDArray[np.bool_]:
        """``bool[rows, cols]``: its disk touches nothing there."""
        return ~inflated(self.obstacles, self._cells(self.robot_m), 0.0)

    @cached_property
    def clear(self) -> NDArray[np.bool_]:
        """``bool[rows, cols]``: nor with the clearance round it."""
        return ~inflated(self.obstacles, self._cells(self.robot_m), self._cells(self.clearance_m))

    def with_robot_at(self, spot_m: Point) -> "Room":
        """Return the room of a robot that stands at a point of the map: what lies under it is no obstacle.

        Else a wrong range, or a cell that nobody saw, would keep it there.
        """
        row, col = self.spec.cell_at(*spot_m)
        if not self.spec.contains(row, col) or self.tight[row, col]:
            return self
        reach = math.ceil(self._cells(_REACH_M + self.robot_m))
        top, left = max(0, row - reach), max(0, col - reach)
        near = self.obstacles[top : row + reach + 1, left : col + reach + 1].copy()
        rows, cols = np.ogrid[top : top + near.shape[0], left : left + near.shape[1]]
        # A cell more: what touches the disk with a corner is under it, too.
        near[np.hypot(rows - row, cols - col) <= self._cells(self.robot_m) + 2.0] = False
        cell_m = self.spec.resolution_m
        origin_m = self.spec.origin_x_m + left * cell_m, self.spec.origin_y_m + top * cell_m
        return Room(GridSpec(cell_m, *origin_m, near.shape), near, self.robot_m, self.clearance_m)

    def touches_nothing(self, one_m: Point, other_m: Point) -> bool:
        """Return whether the disk touches nothing all along a straight leg, map frame."""
        one, other = self.spec.positions_at(np.array((one_m, other_m)))
        cells = touched_cells((float(one[0]), float(one[1])), (float(other[0]), float(other[1])))
        inside = ((cells >= 0) & (cells < self.tight.shape)).all()
        return bool(inside and self.tight[cells[:, 0], cells[:, 1]].all())

    def _cells(self, metres: float) -> float:
        return metres / self.spec.resolution_m


@dataclass(frozen=True, slots=True, eq=False)
class _Place:
    """Where the robot may stand."""

    heading_rad: float
    spot_m: Point
    room: Room

    def seen_from(self, points_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return where points ``float64[n, 2]`` of the robot frame lie on the map."""
        cosine, sine = math.cos(self.heading_rad), math.sin(self.heading_rad)
        turned: NDArray[np.float64] = points_m @ np.array(((cosine, sine), (-sine, cosine)))
        return turned + self.spot_m

    @property
    def _is_clear(self) -> bool:
        cell = self.room.spec.cell_at(*self.spot_m)
        return bool(self.room.spec.contains(*cell) and self.room.clear[cell])

    def is_free(self, points_m: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return at which points the robot may be, ``bool[n]``."""
        cells = np.floor(self.room.spec.positions_at(self.seen_from(points_m))).astype(np.intp)
        inside = np.all((cells >= 0) & (cells < self.room.clear.shape), axis=1)
        row, col = np.where(inside.reshape(-1, 1), cells, 0).T
        off_m = np.hypot(*points_m.T)
        crowded_m = 0.0 if self._is_clear else _CLEAR_FROM_M
        allowed = np.where(off_m <= crowded_m, self.room.tight[row, col], self.room.clear[row, col])
        found: NDArray[np.bool_] = (inside & allowed) | (off_m <= _LEAVING_M)
        return found


@dataclass(frozen=True, eq=False)
class CommonGround:
    """What is free under every rival, in the robot frame, cells as large as the map's."""

    cell_m: float
    places: tuple[_Place, ...]
    """All that are asked."""
    cells: NDArray[np.bool_]
    """``bool[n, n]``: the robot stands in the middle of the middle one."""

    @classmethod
    def of(cls, room: Room, rivals: Sequence[Rival]) -> "CommonGround":
        """Lay the map as seen from all rivals, and from all over each of them, on each other. O(cells x places)."""
        cell_m = room.spec.resolution_m
        places = tuple(
            _Place(rival.pose.heading_rad, spot_m, room.with_robot_at(spot_m))
            for rival in rivals
            for spot_m in rival.spots_m
        )
        half = round(_REACH_M / cell_m)
        axis = np.arange(-half, half + 1) * cell_m
        y_m, x_m = np.meshgrid(axis, axis, indexing="ij")
        points_m = np.column_stack((x_m.reshape(-1), y_m.reshape(-1)))
        left = np.arange(len(points_m))  # where the first places rule out most of it, the others look at little
        for place in places:
            left = left[place.is_free(points_m[left])]
        cells = np.zeros(len(points_m), np.bool_)
        cells[left] = True
        return cls(cell_m, places, cells.reshape(len(axis), len(axis)))

    @cached_property
    def field(self) -> NDArray[np.float64]:
        """How far it is to drive to each cell, ``float64[n, n]`` in cells; inf where no way leads."""
        return distance_field(self.cells, self._middle)

    @property
    def ways_m(self) -> NDArray[np.float64]:
        """The same in metres."""
        return self.field * self.cell_m

    def point_m(self, cell: Cell) -> Point:
        """Return where a cell's centre lies."""
        half = self._middle[0]
        return (cell[1] - half) * self.cell_m, (cell[0] - half) * self.cell_m

    def way_to(self, cell: Cell) -> tuple[Point, ...]:
        """Return the corners of the way to a cell that :attr:`field` reaches, the robot first, pulled straight."""
        way = descent(self.field, cell)[::-1]
        corners = pulled_straight(self.cells, [centre_of(one) for one in way])
        return tuple(self.point_m(way[corner]) for corner in corners)

    def is_free(self, one: Point, other: Point) -> bool:
        """Return whether the robot touches nothing along a leg, wherever it stands; near to its start it may.

        Exact, cell by cell of the map, which the cells of this ground, that lie askew to them, are not.
        """
        if math.hypot(*one) < _LEAVING_M:
            length_m = math.hypot(*other)
            if length_m <= _LEAVING_M:
                return True
            one = other[0] * _LEAVING_M / length_m, other[1] * _LEAVING_M / length_m
        leg = np.array((one, other))
        return all(place.room.touches_nothing(*map(tuple, place.seen_from(leg).tolist())) for place in self.places)

    def free_part(self, way: Sequence[Point], most_m: float) -> tuple[Point, ...]:
        """Return the beginning of a way without its start, so far as it is free and no longer than ``most_m``."""
        part: list[Point] = []
        for one, other in itertools.pairwise(way):
            length_m = math.dist(one, other)
            share = min(1.0, most_m / length_m) if length_m > 0.0 else 0.0
            end = one[0] + share * (other[0] - one[0]), one[1] + share * (other[1] - one[1])
            if share == 0.0 or not self.is_free(one, end):
                break
            part.append(end)
            most_m -= share * length_m
        return tuple(part)

    @property
    def _middle(self) -> Cell:
        half = len(self.cells) // 2
        return half, half
