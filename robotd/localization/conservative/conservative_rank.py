"""Counting what cannot be excluded: the rank of the conservative mode, over all cells and headings.

What is counted is defined and proved in :mod:`.conservative_poses`; how, by :mod:`robotd.grid.kernels`.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.grid import kernels
from robotd.grid.drawn import Drawn
from robotd.grid.fans import STARTS_MAX, FanBeams, direction_keys, draw_fans, start_keys
from robotd.grid.kernels.shared.packed_map import Words, pack
from robotd.grid.readings import Readings
from robotd.localization.conservative.conservative_poses import (
    ErrorBounds,
    SureObstacles,
    grown_ending,
    head_radius_steps,
)
from robotd.localization.count.rank_grid import RankGrid
from robotd.localization.obstacles.beam_obstacles import Obstacles
from robotd.localization.obstacles.prepared_map import PreparedMap

_WINDOWS_AT_ONCE = 1 << 20
"""Fans are drawn in blocks of this many windows: 100 MB at most while they are."""


@dataclass(frozen=True, slots=True, eq=False)
class ConservativeMap:
    """A map made ready for the conservative mode; shared by all that localize on it."""

    prepared: PreparedMap
    """Its free cells and its blocking ones; not grown, for that depends on the reading."""
    obstacles: SureObstacles
    bounds: ErrorBounds
    _grown: dict[int, Words] = field(default_factory=dict)
    """By radius, in quarters of a cell, as readings ask for them."""

    @classmethod
    def of(cls, obstacles: SureObstacles, spec: GridSpec, bounds: ErrorBounds) -> "ConservativeMap":
        """Prepare a map.

        Raises:
            ValueError: the obstacles do not fit the spec.
        """
        error_cells = bounds.range_error_m / spec.resolution_m
        sets = Obstacles(
            obstacles.standing, obstacles.blocking, obstacles.ending, outside_blocks=obstacles.outside_blocks
        )
        return cls(PreparedMap.of(sets, spec, error_cells), obstacles, bounds)

    @property
    def spec(self) -> GridSpec:
        """Where the map lies."""
        return self.prepared.spec

    def grown(self, radius_steps: int) -> Words:
        """Return what may end a beam, grown by a radius of this many quarter cells, packed."""
        # Kept with the map, not with the stop: radii are rounded so coarsely that every stop asks for the same
        # few.
        if radius_steps not in self._grown:
            plane = grown_ending(self.obstacles, radius_steps)
            self._grown[radius_steps] = pack(plane, self.prepared.packed.origin, outside=True)
        return self._grown[radius_steps]


class ConservativeRankGrid(RankGrid):
    """Counts by how many readings each pose is not excluded; the true one never is, by readings within the bounds.

    As a :class:`.RankGrid` in all else. The headings must be such that the true one lies
    within the bound of one of them.
    """

    def __init__(self, the_map: ConservativeMap, headings_rad: Sequence[float], *, threads: int = 1) -> None:
        """Begin with no readings; arguments as of the :class:`~robotd.localization.count.rank_grid.RankGrid`."""
        super().__init__(the_map.prepared, headings_rad, threads=threads)
        self._sure = the_map

    def _count_with_room(self, readings: Readings, on: PreparedMap, *, subtract: bool) -> None:
        fanned = _FannedReadings.of(readings, self._headings, self._sure)
        for beams in fanned.fan_beams():
            threads = self._threads_for(len(beams.beams))
            kernels.in_use().fans.count_fans(
                self._counters, on.packed, fanned.grown, beams, subtract=subtract, threads=threads
            )


@dataclass(frozen=True, slots=True, eq=False)
class _FannedReadings:
    """All readings at all headings, reading after reading."""

    drawn: Drawn
    lengths: NDArray[np.float64]
    """Way that was surely free, in cells."""
    beams: NDArray[np.int32]
    """``int32[n, 5]``, as in :class:`~robotd.grid.fans.FanBeams`; how many lines are crossed is yet to be found."""
    grown: list[Words]
    turn_rad: float
    line_count: int

    @classmethod
    def of(cls, readings: Readings, headings: NDArray[np.float64], the_map: ConservativeMap) -> "_FannedReadings":
        resolution_m, bounds = the_map.spec.resolution_m, the_map.bounds
        bearing, range_cells, x, y, is_miss = (readings.rows / [1.0, *[resolution_m] * 3, 1.0]).T[:, :, None]
        error_cells = bounds.range_error_m / resolution_m
        away = np.hypot(x + range_cells * np.cos(bearing), y + range_cells * np.sin(bearing))
        # A miss has no head and needs no grown map; 0 keeps it from asking for one more radius.
        steps = np.where(is_miss > 0.0, 0, head_radius_steps(away, error_cells, bounds.heading_error_rad))
        radii, radius = np.unique(steps, return_inverse=True)
        drawn, count = Drawn.of(readings, headings, resolution_m), headings.shape[1]
        heads = drawn.head_cells
        which = np.where(is_miss > 0.0, -1, radius.reshape(-1, 1)) * np.ones(count)
        heading = np.arange(count) * np.ones_like(bearing)
        beams = np.column_stack((np.zeros(len(heads)), heading.ravel(), which.ravel(), heads)).astype(np.int32)
        # Misses, too: the cut-off errs as much as any range.
        lengths = drawn.range_cells - error_cells
        line_count = int(min(sum(the_map.spec.shape), max(1.0, np.ceil(lengths.max()) + 1.0)))
        grown = [the_map.grown(int(number)) for number in radii]
        return cls(drawn, lengths, beams, grown, bounds.heading_error_rad, line_count)

    def fan_beams(self) -> Iterator[FanBeams]:
        """Yield them by fans, block by block."""
        directions, starts, fan = self._shared()
        # Blocks bound the memory whatever the number of readings and headings is; their order changes no count.
        size = max(1, _WINDOWS_AT_ONCE // self.line_count)
        for first in range(0, len(directions), size):
            block = slice(first, first + size)
            fans = draw_fans(directions[block], starts[block], self.turn_rad, self.line_count)
            # All beams of one fan are in one block, so no fan is drawn twice.
            mine = np.flatnonzero((fan >= first) & (fan < first + size))
            beams = self.beams[mine]
            beams[:, 0] = fans.lines_crossed(fan[mine] - first, self.lengths[mine])
            yield FanBeams.of(fans, fan[mine] - first, beams)

    def _shared(self) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.intp]]:
        """Return the directions and starts of the fans, and which fan each beam belongs to."""
        directions, starts = direction_keys(self.drawn.bearings_rad), start_keys(self.drawn.starts)
        _, direction = np.unique(directions, return_inverse=True)
        # Pairs as single integers, which NumPy sorts sooner than rows.
        codes, start = np.unique(starts[:, 0] * (4 * STARTS_MAX) + starts[:, 1], return_inverse=True)
        _, one, fan = np.unique(direction * len(codes) + start, return_index=True, return_inverse=True)
        return directions[one], starts[one], fan.reshape(-1)
