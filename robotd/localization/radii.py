"""What the settings of the error radius come to on a map."""

import math

from robotd.core.grid_spec import GridSpec
from robotd.grid.error_radii import ErrorRadii
from robotd.localization.obstacles.error_radius import ErrorRadius
from robotd.localization.settings import LocalizationSettings

_ROUNDED_CELLS = 1.0
"""What cells round away of a perfect reading: with half of it every other is lost at the true cell, with it one in
fifty."""


def radii_of(settings: LocalizationSettings, spec: GridSpec) -> ErrorRadii:
    """Return the error radii that settings mean on a map."""
    radius_cells = settings.error_radius_cells(spec.resolution_m)
    if settings.error_radius is ErrorRadius.CONSTANT:
        return ErrorRadii((radius_cells,))
    # No beam that ends on the map goes farther than from corner to corner.
    return ErrorRadii.growing(max(radius_cells, _ROUNDED_CELLS), angle_error_rad(settings), math.hypot(*spec.shape))


def angle_error_rad(settings: LocalizationSettings) -> float:
    """Return how far a reading may be off by its angle, at the nearest heading that is tried."""
    return settings.heading_step_rad / 2 + settings.bearing_error_rad
