"""How many counts make a unit of way, from legs whose ways are known."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.errors import CalibrationError


@dataclass(frozen=True, slots=True, eq=False)
class Scale:
    """Counts per unit."""

    per_unit: float
    error: float
    """Standard deviation of ``per_unit``."""
    residuals: NDArray[np.float64]
    """``float64[n]``: how much longer each leg was than its counts say, in units of way."""


def fit_scale(counts: NDArray[np.float64], ways: NDArray[np.float64], errors: NDArray[np.float64]) -> Scale:
    """Return the scale through zero, by weighted least squares.

    Args:
        counts: ``float64[n]``, of each leg.
        ways: ``float64[n]``: how far it led, with its sign.
        errors: ``float64[n]``: standard deviations of the ways.

    The error is what the ways' errors come to, or what the legs' own disagreement does if that is more: wheels slip.

    Raises:
        CalibrationError: the legs lead nowhere, or the encoder did not count.
    """
    if not np.any(np.abs(ways) > 3.0 * errors):
        raise CalibrationError("no leg led far enough to tell a scale: go farther")
    # The ways are in error, not the counts: ways = counts / scale.
    weights = errors**-2.0
    square = float((weights * counts**2).sum())
    unit_per_count = float((weights * counts * ways).sum()) / square if square else 0.0
    if unit_per_count == 0.0:
        raise CalibrationError("the encoder counted nothing on the way")
    residuals = ways - counts * unit_per_count
    free = max(1, len(ways) - 1)
    disagreement = float((weights * residuals**2).sum()) / free
    error = np.sqrt(max(1.0, disagreement) / square)
    return Scale(1.0 / unit_per_count, float(error) / unit_per_count**2, residuals)
