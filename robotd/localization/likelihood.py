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

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.grid import kernels
from robotd.grid.kernels.endings import IN_UNKNOWN
from robotd.grid.spec import GridSpec
from robotd.grid.tables import NO_INFORMATION, SURELY_OCCUPIED
from robotd.localization.elsewhere import elsewhere
from robotd.localization.error_model import ErrorModel


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """Readings, drawn once for all poses."""

    beams: NDArray[np.float64]
    """``float64[m, 8]``, as :func:`~robotd.grid.kernels.weigh_beams` takes them."""
    elsewhere: NDArray[np.float64]
    """``float64[m]``, how likely each is somewhere in any building."""
    unseen: NDArray[np.float64]
    """``float64[m]``, how much likelier that is than a plain rate of obstacles: readings that end where nobody has
    looked are as readings are anywhere."""
    meaningless: NDArray[np.float64]
    """``float64[m]``, how likely each is to mean nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class Likelihood:
    """The likelihood of readings on one map."""

    spec: GridSpec
    cells: NDArray[np.uint8]
    """``uint8[rows, cols]``, the evidence of the occupancy grid."""
    model: ErrorModel

    @property
    def vacant_m2(self) -> float:
        """How much room the robot has."""
        return float(np.count_nonzero(self.cells < NO_INFORMATION)) * self.spec.resolution_m**2

    def sight(self, readings: NDArray[np.float64]) -> Sight:
        """Return readings ``float64[m, 5]`` (:func:`~robotd.grid.readings.numbers_of`), by bearing, drawn."""
        model, resolution_m = self.model, self.spec.resolution_m
        bearing_rad, range_m, x_m, y_m, is_miss = readings.T
        across_m = np.hypot(model.map_sigma_m, model.map_sigma_rad * range_m)
        along_m = np.sqrt(model.range_sigma_m**2 + across_m**2 + resolution_m**2 / 12.0)
        x, y, *lengths = np.stack((x_m, y_m, range_m, along_m, across_m)) / resolution_m
        beams = np.stack((x, y, np.cos(bearing_rad), np.sin(bearing_rad), *lengths, is_miss), axis=1)
        is_hit, likely = is_miss == 0.0, elsewhere(readings, model)
        return Sight(beams, likely, likely / model.anywhere(range_m, is_hit), model.meaningless(is_hit))

    def densities(self, sight: Sight, poses: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how likely readings are by where they end, ``float64[n, m, 3]``.

        At an obstacle of the map (a miss: nowhere), where nobody has looked, in a vacant cell: for hits the density of
        the range [1/m], for misses the chance.

        Args:
            sight: ``m`` readings.
            poses: ``float64[n, 3]``: x, y [m] and heading [rad], map frame.
        """
        at = np.column_stack((self.spec.positions_at(poses[:, :2]), np.cos(poses[:, 2]), np.sin(poses[:, 2])))
        densities = kernels.weigh_beams(self.cells, self._stops(), at, sight.beams)
        densities[:, sight.beams[:, 7] == 0.0] /= self.spec.resolution_m
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

    def _stops(self) -> NDArray[np.float64]:
        """Return the chance of each cell value to stop a beam, for the kernel."""
        model, values = self.model, np.arange(SURELY_OCCUPIED + 1)
        obstacle = np.minimum(values / SURELY_OCCUPIED, 1.0 - model.removed_share)
        rate = np.where(values == NO_INFORMATION, model.unknown_per_m, model.unmapped_per_m)
        return np.where(values > NO_INFORMATION, obstacle, -np.expm1(-rate * self.spec.resolution_m))
