"""How readings err, and maps: sizes and frequencies, the same for every building."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_NEVER = 600.0
"""Less than exp(-this) is no number that can be divided by."""


@dataclass(frozen=True, slots=True)
class ErrorModel:
    """How large and how frequent errors are. None was fitted to a building: sensors' and map-makers' usual figures."""

    range_sigma_m: float = 0.015
    """Standard deviation of a range; SICK scanners on standing robots showed 0.9 and 1.1 cm."""
    map_sigma_m: float = 0.03
    """How far walls lie from where the map has them, one standard deviation, along a beam and across it."""
    map_sigma_rad: float = 0.004
    """How far the map-maker's headings were off: walls far away lie aside."""
    map_sharpness_sigma: float = 0.11
    """How much likelier a place may seem only because the map happens to show it more sharply: standard deviation of
    the logarithm, for each independent reading; so it was between simulated rooms that are alike."""
    removed_share: float = 0.1
    """Chance that an obstacle of which the map is sure stands there no more, or lets a beam pass."""
    unmapped_per_m: float = 0.02
    """Rate of things that are not on the map along a beam through vacant cells: people, chairs."""
    unknown_per_m: float = 0.3
    """Rate of obstacles along a beam where nobody has looked."""
    outlier_share: float = 0.05
    """Share of the readings that mean nothing on this map: people, edges, reflections; 1 to 5 % in buildings."""
    outlier_span_m: float = 8.0
    """Such readings lie anywhere up to so far."""

    def __post_init__(self) -> None:
        """Refuse impossible values."""
        for name in ("range_sigma_m", "outlier_span_m", "unmapped_per_m", "unknown_per_m"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name} must be positive, got {getattr(self, name)}")
        for name in ("map_sigma_m", "map_sigma_rad", "map_sharpness_sigma"):
            if not getattr(self, name) >= 0.0:
                raise ValueError(f"{name} must not be negative, got {getattr(self, name)}")
        for name in ("removed_share", "outlier_share"):
            if not 0.0 < getattr(self, name) < 1.0:
                raise ValueError(f"{name} must lie between 0 and 1, got {getattr(self, name)}")

    def meaningless(self, is_hit: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Return how likely readings are to mean nothing: for hits the density [1/m], for misses the chance."""
        return np.where(is_hit, self.outlier_share / self.outlier_span_m, self.outlier_share)

    def anywhere(self, range_m: NDArray[np.float64], is_hit: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Return how likely readings are where nobody has looked: for hits the density [1/m], for misses the chance."""
        passed = np.exp(-np.minimum(self.unknown_per_m * range_m, _NEVER))
        return np.where(is_hit, self.unknown_per_m * passed, passed)
