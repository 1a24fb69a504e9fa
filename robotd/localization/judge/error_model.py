"""How readings err, and maps: sizes and frequencies, the same for every building."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from robotd.core.bounds import Within, refuse_outside

_NEVER = 600.0
"""Less than exp(-this) is no number that can be divided by."""


@dataclass(frozen=True, slots=True)
class ErrorModel:
    """How large and how frequent errors are. None was fitted to a building: sensors' and map-makers' usual figures."""

    range_sigma_m: Annotated[float, Within(1e-4, 1.0, "m")] = 0.015
    """Standard deviation of a range; SICK scanners on standing robots showed 0.9 and 1.1 cm."""
    map_sigma_m: Annotated[float, Within(0.0, 1.0, "m")] = 0.03
    """How far walls lie from where the map has them, one standard deviation, along a beam and across it."""
    map_sigma_rad: Annotated[float, Within(0.0, 0.5, "rad")] = 0.004
    """How far the map-maker's headings were off: walls far away lie to the side."""
    map_sharpness_sigma: Annotated[float, Within(0.0, 10.0)] = 0.11
    """How much likelier a place may seem only because the map happens to show it more sharply: standard deviation of
    the logarithm, for each independent reading; so it was between simulated rooms that are alike."""
    mapped_walls_go_on: Annotated[float, Within(0.0, 0.99, "of 1")] = 0.6
    """Chance that the wall of the last two readings goes straight on to the next where the map has a wall, as in
    any building."""
    removed_share: Annotated[float, Within(1e-6, 0.99, "of 1")] = 0.1
    """Chance that an obstacle of which the map is sure stands there no more, or lets a beam pass."""
    unmapped_per_m: Annotated[float, Within(1e-6, 10.0, "1/m")] = 0.02
    """Rate of things that are not on the map along a beam through vacant cells: people, chairs."""
    unknown_per_m: Annotated[float, Within(1e-6, 10.0, "1/m")] = 0.3
    """Rate of obstacles along a beam where nobody has looked."""
    outlier_share: Annotated[float, Within(1e-6, 0.99, "of 1")] = 0.05
    """Share of the readings that mean nothing on this map: people, edges, reflections; 1 to 5 % in buildings."""
    outlier_span_m: Annotated[float, Within(0.1, 1000.0, "m")] = 8.0
    """Such readings lie anywhere up to so far."""

    def __post_init__(self) -> None:
        """Refuse impossible values."""
        refuse_outside(self)

    def meaningless(self, is_hit: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Return how likely readings are to mean nothing: for hits the density [1/m], for misses the chance."""
        return np.where(is_hit, self.outlier_share / self.outlier_span_m, self.outlier_share)

    def anywhere(self, range_m: NDArray[np.float64], is_hit: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Return how likely readings are where nobody has looked: for hits the density [1/m], for misses the chance."""
        # An exponential way to the first obstacle: where nobody has looked, each metre is as likely as the next
        # to hold one.
        passed = np.exp(-np.minimum(self.unknown_per_m * range_m, _NEVER))
        return np.where(is_hit, self.unknown_per_m * passed, passed)
