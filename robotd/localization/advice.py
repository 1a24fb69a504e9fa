"""Settings that cannot work on a map, in words that name one and the value to take."""

from robotd.core.grid_spec import GridSpec
from robotd.localization.obstacles.error_radius import ErrorRadius
from robotd.localization.settings import LocalizationSettings

_LOST_BELOW_CELLS = 0.55
"""With a radius of half a cell every other perfect reading is lost at the true cell."""


def advice_on(settings: LocalizationSettings, spec: GridSpec) -> str | None:
    """Return what is at odds with the cells of a map; None if they go together.

    >>> advice_on(LocalizationSettings(), GridSpec(0.05, 0.0, 0.0, (10, 10))) is None
    True
    """
    cell_m = spec.resolution_m
    is_constant = settings.error_radius is ErrorRadius.CONSTANT
    if not is_constant or settings.conservative or settings.range_error_m >= _LOST_BELOW_CELLS * cell_m:
        return None
    return (
        f"localization.range_error_m = {settings.range_error_m:g} is no more than cells of {cell_m:g} m round away:"
        f" half of all readings are lost at the true place; take {cell_m:g}"
    )
