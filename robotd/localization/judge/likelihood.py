"""The likelihood of a sweep at a pose, reading by reading.

The count of feasible readings ([BrownDonald2000]_ sec. 2.2.1) knows yes and no. Most wrong answers on real logs explain
as many readings as the right one, but not as well: this says how well.

A reading was sent through a map of chances. Each cell stops a beam with a chance that its evidence gives: surely mapped
obstacles nearly always (something may have been moved away), unknown cells at a rate as in any building, vacant ones
seldom (something new stands there). So what is explained, what is not, what ends in the unknown and what goes through
walls are all one density, and it integrates to one: a pose gains nothing by facing much clutter or the unknown.
Around the obstacle that stops it, a reading scatters by the error of the sensor and that of the map; the robot that
made the map knew its poses to a few centimetres and to a fraction of a degree.

Readings that follow each other along a wall of the map say more than its cells do: the wall goes on straight, there as
anywhere (:mod:`.elsewhere`). Without that, no place of a map of coarse cells was as likely as being nowhere.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.grid import kernels
from robotd.grid.growth import grown_by_disk, grown_by_disk_updated
from robotd.grid.kernels.cast.cast_kernel import SKIP_MAX
from robotd.grid.kernels.weigh.weigh_kernel import IN_UNKNOWN, ChanceMap
from robotd.grid.readings import Readings
from robotd.grid.tables import NO_INFORMATION, SURELY_OCCUPIED
from robotd.grid.window import CellWindow, influence
from robotd.localization.judge.elsewhere import GoingOn, elsewhere, going_on, or_going_on
from robotd.localization.judge.error_model import ErrorModel

_ON_WALL_M = 0.075


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """Readings, drawn once for all poses."""

    beams: NDArray[np.float64]
    """``float64[m, 8]``, as :meth:`.WeighKernel.weigh_beams` takes them."""
    going_on: GoingOn
    """What is expected of each if walls go on straight."""
    elsewhere: NDArray[np.float64]
    """``float64[m]``, how likely each is somewhere in any building."""
    seen_so_far: NDArray[np.float64]
    """``float64[m]``, the chance that nothing that is not on the map stands before its end."""
    unseen: NDArray[np.float64]
    """``float64[m]``, how much likelier that is than a plain rate of obstacles: readings that end where nobody has
    looked are as readings are anywhere."""
    meaningless: NDArray[np.float64]
    """``float64[m]``, how likely each is to mean nothing."""

    @property
    def is_hit(self) -> NDArray[np.bool_]:
        """Which of them ended somewhere, ``bool[m]``."""
        hit: NDArray[np.bool_] = self.beams[:, 7] == 0.0
        return hit


@dataclass(frozen=True, slots=True, eq=False)
class Likelihood:
    """The likelihood of readings on one map."""

    spec: GridSpec
    model: ErrorModel
    chances: ChanceMap
    on_walls: NDArray[np.bool_]
    """``bool[rows, cols]``: where a wall that goes on is one of the map's."""
    vacant_cells: int
    """In this many the robot may be."""

    @classmethod
    def of(cls, spec: GridSpec, cells: NDArray[np.uint8], model: ErrorModel) -> "Likelihood":
        """Prepare a map: ``uint8[rows, cols]``, the evidence of the occupancy grid, which is copied. O(cells)."""
        # Copied: the grid goes on changing, and what is prepared must stay of one moment.
        own = np.array(cells, np.uint8, order="C")
        chances = ChanceMap(own, skips_of(own), _stops(model, spec.resolution_m))
        on_walls = grown_by_disk(own > NO_INFORMATION, _on_wall_cells(spec))
        return cls(spec, model, chances, on_walls, _vacant(own))

    def updated(self, cells: NDArray[np.uint8], changed: CellWindow) -> "Likelihood":
        """Return the likelihood on a map that differs from this one's in a window alone; this one stays as it is.

        The result is as if made from nothing. O(cells of the window, and of a rim round it), and a copy.
        """
        if changed.is_empty:
            return self
        own, skips = np.array(cells, np.uint8, order="C"), self.chances.skips.copy()
        here, there, part = (window.slices for window in influence(changed, SKIP_MAX, self.spec.shape))
        skips[here] = skips_of(np.ascontiguousarray(own[part]))[there]
        walls, radius_cells = own > NO_INFORMATION, _on_wall_cells(self.spec)
        on_walls = grown_by_disk_updated(self.on_walls, walls, changed, radius_cells)
        # Counted in the window alone, on both sides of the change.
        more = _vacant(own[changed.slices]) - _vacant(self.chances.cells[changed.slices])
        chances = replace(self.chances, cells=own, skips=skips)
        return replace(self, chances=chances, on_walls=on_walls, vacant_cells=self.vacant_cells + more)

    @property
    def vacant_m2(self) -> float:
        """How much room the robot has."""
        return self.vacant_cells * self.spec.resolution_m**2

    def with_model(self, model: ErrorModel) -> "Likelihood":
        """Return the likelihood on the same map for other errors."""
        return replace(self, model=model, chances=replace(self.chances, stops=_stops(model, self.spec.resolution_m)))

    def sight(self, readings: Readings) -> Sight:
        """Return readings, by bearing, drawn."""
        model, resolution_m = self.model, self.spec.resolution_m
        bearing_rad, range_m = readings.bearing_rad, readings.range_m
        across_m = np.hypot(model.map_sigma_m, model.map_sigma_rad * range_m)
        # A twelfth of the square is the variance of a wall that lies anywhere in its cell, all places being as likely.
        along_m = np.sqrt(model.range_sigma_m**2 + across_m**2 + resolution_m**2 / 12.0)
        x, y, *lengths = np.stack((readings.start_x_m, readings.start_y_m, range_m, along_m, across_m)) / resolution_m
        beams = np.stack((x, y, np.cos(bearing_rad), np.sin(bearing_rad), *lengths, readings.is_miss), axis=1)
        is_hit, straight = readings.is_hit, going_on(readings, model)
        likely = elsewhere(readings, model, straight)
        free = np.exp(-model.unmapped_per_m * range_m)
        unseen = likely / model.anywhere(range_m, is_hit)
        return Sight(beams, straight, likely, free, unseen, model.meaningless(is_hit))

    def densities(self, sight: Sight, poses: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how likely readings are by where they end, ``float64[n, m, 3]``.

        At an obstacle of the map (a miss: nowhere), where nobody has looked, in a vacant cell: for hits the density of
        the range [1/m], for misses the chance.

        Args:
            sight: ``m`` readings.
            poses: ``float64[n, 3]``: x, y [m] and heading [rad], map frame.
        """
        at = np.column_stack((self.spec.positions_at(poses[:, :2]), np.cos(poses[:, 2]), np.sin(poses[:, 2])))
        densities = kernels.in_use().weigh.weigh_beams(self.chances, at, sight.beams)
        # The kernel's densities are per cell; a miss has a chance, which is without unit.
        densities[:, sight.is_hit] /= self.spec.resolution_m
        densities *= sight.seen_so_far[:, None]
        densities[:, :, IN_UNKNOWN] *= sight.unseen
        return densities

    def logs(self, sight: Sight, poses: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the logarithm of the likelihood of each reading at each pose, ``float64[n, m]``."""
        mapped = self.densities(sight, poses).sum(axis=2)
        straight = sight.going_on
        goes_on = straight.is_wall & self._is_on_walls(straight.heads_m, poses)
        chances = self.model.mapped_walls_go_on * goes_on
        return self._with_meaningless(sight, or_going_on(mapped, straight.densities, chances))

    def elsewhere_logs(self, sight: Sight) -> NDArray[np.float64]:
        """Return the same for a robot that is not on the map, ``float64[m]``."""
        return self._with_meaningless(sight, sight.elsewhere)

    def _is_on_walls(self, heads_m: NDArray[np.float64], poses: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return whether points ``float64[m, 2]``, robot frame, lie on walls of the map, ``bool[n, m]`` by pose."""
        cos, sin = np.cos(poses[:, 2, None]), np.sin(poses[:, 2, None])
        x_m = poses[:, 0, None] + cos * heads_m[:, 0] - sin * heads_m[:, 1]
        y_m = poses[:, 1, None] + sin * heads_m[:, 0] + cos * heads_m[:, 1]
        at = self.spec.flat_at(np.stack((x_m, y_m), axis=-1).reshape(-1, 2))
        # Off the map the index would count from the end, so it is held at 0 and its answer is dropped.
        return ((at >= 0) & self.on_walls.ravel()[np.maximum(at, 0)]).reshape(x_m.shape)

    def _with_meaningless(self, sight: Sight, densities: NDArray[np.float64]) -> NDArray[np.float64]:
        logs: NDArray[np.float64] = np.log((1.0 - self.model.outlier_share) * densities + sight.meaningless)
        return logs


def skips_of(cells: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return how far it is to the next cell of another kind, ``uint8[rows, cols]``, as :class:`ChanceMap` has it."""
    unknown, vacant, none = cells == NO_INFORMATION, cells < NO_INFORMATION, np.zeros(cells.shape, np.bool_)
    over_vacant = kernels.in_use().cast.skip_codes(~vacant, none)[1:-1, 1:-1]
    over_unknown = kernels.in_use().cast.skip_codes(~unknown, none)[1:-1, 1:-1]
    return np.where(vacant, over_vacant, np.where(unknown, over_unknown, 1)).astype(np.uint8)


def _on_wall_cells(spec: GridSpec) -> float:
    """Return how far from a wall's cells a point is still on it: as far as cells round, and as maps err."""
    return max(1.5, _ON_WALL_M / spec.resolution_m)


def _vacant(cells: NDArray[np.uint8]) -> int:
    return int(np.count_nonzero(cells < NO_INFORMATION))


def _stops(model: ErrorModel, resolution_m: float) -> NDArray[np.float64]:
    """Return what each cell value means to a beam, ``float64[256]``, for the kernel."""
    values = np.arange(SURELY_OCCUPIED + 1)
    # Never certain: a single chair that was moved would make its place impossible.
    obstacle = np.minimum(values / SURELY_OCCUPIED, 1.0 - model.removed_share)
    rate = np.where(
        # As a chance for the length of a cell; `expm1`, as that is small and one less its exponential would
        # lose places.
        values == NO_INFORMATION,
        -np.expm1(-model.unknown_per_m * resolution_m),
        model.unmapped_per_m * resolution_m,
    )
    return np.where(values > NO_INFORMATION, obstacle, rate)
