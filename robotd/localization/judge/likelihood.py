"""The likelihood of a sweep at a pose, reading by reading.

The count of feasible readings ([BrownDonald2000]_ sec. 2.2.1) knows yes and no. Most wrong answers on real logs explain
as many readings as the right one, but not as well: this says how well.

A reading was sent through a map of chances. Each cell stops a beam with a chance that its evidence gives: surely mapped
obstacles nearly always (something may have been moved away), unknown cells at a rate as in any building, vacant ones
seldom (something new stands there). So what is explained, what is not, what ends in the unknown and what goes through
walls are all one density, and it integrates to one: a pose gains nothing by facing much clutter or the unknown.
Around the obstacle that stops it, a reading scatters by the error of the sensor and that of the map; the robot that
made the map knew its poses to a few centimetres and to a fraction of a degree.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.grid import kernels
from robotd.grid.kernels.cast.cast_kernel import SKIP_MAX
from robotd.grid.kernels.weigh.weigh_kernel import IN_UNKNOWN, ChanceMap
from robotd.grid.readings import Readings
from robotd.grid.tables import NO_INFORMATION, SURELY_OCCUPIED
from robotd.grid.window import CellWindow, influence
from robotd.localization.judge.elsewhere import elsewhere
from robotd.localization.judge.error_model import ErrorModel


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """Readings, drawn once for all poses."""

    beams: NDArray[np.float64]
    """``float64[m, 8]``, as :meth:`.WeighKernel.weigh_beams` takes them."""
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
    vacant_cells: int
    """In this many the robot may be."""

    @classmethod
    def of(cls, spec: GridSpec, cells: NDArray[np.uint8], model: ErrorModel) -> "Likelihood":
        """Prepare a map: ``uint8[rows, cols]``, the evidence of the occupancy grid, which is copied. O(cells)."""
        own = np.array(cells, np.uint8, order="C")
        chances = ChanceMap(own, skips_of(own), _stops(model, spec.resolution_m))
        return cls(spec, model, chances, _vacant(own))

    def updated(self, cells: NDArray[np.uint8], changed: CellWindow) -> "Likelihood":
        """Return the likelihood on a map that differs from this one's in a window alone; this one stays as it is.

        The result is as if made from nothing. O(cells of the window, and of a rim round it), and a copy.
        """
        if changed.is_empty:
            return self
        own, skips = np.array(cells, np.uint8, order="C"), self.chances.skips.copy()
        here, there, part = (window.slices for window in influence(changed, SKIP_MAX, self.spec.shape))
        skips[here] = skips_of(np.ascontiguousarray(own[part]))[there]
        # Counted in the window alone, on both sides of the change.
        more = _vacant(own[changed.slices]) - _vacant(self.chances.cells[changed.slices])
        chances = replace(self.chances, cells=own, skips=skips)
        return replace(self, chances=chances, vacant_cells=self.vacant_cells + more)

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
        is_hit, likely = readings.is_hit, elsewhere(readings, model)
        free = np.exp(-model.unmapped_per_m * range_m)
        return Sight(beams, likely, free, likely / model.anywhere(range_m, is_hit), model.meaningless(is_hit))

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
        return self._with_meaningless(sight, self.densities(sight, poses).sum(axis=2))

    def elsewhere_logs(self, sight: Sight) -> NDArray[np.float64]:
        """Return the same for a robot that is not on the map, ``float64[m]``."""
        return self._with_meaningless(sight, sight.elsewhere)

    def _with_meaningless(self, sight: Sight, densities: NDArray[np.float64]) -> NDArray[np.float64]:
        logs: NDArray[np.float64] = np.log((1.0 - self.model.outlier_share) * densities + sight.meaningless)
        return logs


def skips_of(cells: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return how far it is to the next cell of another kind, ``uint8[rows, cols]``, as :class:`ChanceMap` has it."""
    unknown, vacant, none = cells == NO_INFORMATION, cells < NO_INFORMATION, np.zeros(cells.shape, np.bool_)
    over_vacant = kernels.in_use().cast.skip_codes(~vacant, none)[1:-1, 1:-1]
    over_unknown = kernels.in_use().cast.skip_codes(~unknown, none)[1:-1, 1:-1]
    return np.where(vacant, over_vacant, np.where(unknown, over_unknown, 1)).astype(np.uint8)


def _vacant(cells: NDArray[np.uint8]) -> int:
    return int(np.count_nonzero(cells < NO_INFORMATION))


def _stops(model: ErrorModel, resolution_m: float) -> NDArray[np.float64]:
    """Return what each cell value means to a beam, ``float64[256]``, for the kernel."""
    values = np.arange(SURELY_OCCUPIED + 1)
    obstacle = np.minimum(values / SURELY_OCCUPIED, 1.0 - model.removed_share)
    rate = np.where(
        values == NO_INFORMATION, -np.expm1(-model.unknown_per_m * resolution_m), model.unmapped_per_m * resolution_m
    )
    return np.where(values > NO_INFORMATION, obstacle, rate)
