"""Settings that cannot work together on a map, in words that name one and the value to take."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from robotd.core.grid_spec import GridSpec
from robotd.grid.between import APART_MAX_RAD
from robotd.grid.settings import BetweenBeams
from robotd.localization.obstacles.error_radius import ErrorRadius
from robotd.localization.radii import angle_error_rad, radii_of
from robotd.localization.settings import LocalizationSettings

_LOST_BELOW_CELLS = 0.55
"""With a radius of half a cell every other perfect reading is lost at the true cell."""


@dataclass(frozen=True, slots=True)
class SweepFacts:
    """What matters of a sweep to whether it can be found on a map."""

    readings: int
    """Once round."""
    reach_m: float
    """How far the rangefinder sees."""
    between_beams: BetweenBeams
    """What a map takes the ground between two of its beams for."""


def advice_on(settings: LocalizationSettings, spec: GridSpec, sweep: SweepFacts) -> str | None:
    """Return the gravest of what cannot work together on the cells of a map; None if all goes together.

    >>> sweep = SweepFacts(300, 6.0, BetweenBeams.SEEN)
    >>> advice_on(LocalizationSettings(), GridSpec(0.05, 0.0, 0.0, (10, 10)), sweep) is None
    True
    """
    # The conservative mode takes its radii from bounds of its own, and asks nothing of the map between beams.
    if settings.conservative:
        return None
    # One at a time, the gravest: mending that often mends the others.
    return next(_at_odds(settings, spec, sweep), None)


def _at_odds(settings: LocalizationSettings, spec: GridSpec, sweep: SweepFacts) -> Iterator[str]:
    cell_m, is_constant = spec.resolution_m, settings.error_radius is ErrorRadius.CONSTANT
    if is_constant and settings.range_error_m < _LOST_BELOW_CELLS * cell_m:
        yield (
            f"localization.range_error_m = {settings.range_error_m:g} is no more than cells of {cell_m:g} m round away:"
            f" half of all readings are lost at the true place; take {cell_m:g}"
        )
    step_rad, most_rad = settings.heading_step_rad, _most_heading_step_rad(settings, spec, sweep.reach_m)
    # Not positive means that bearings alone err by more than any step could: then finer headings would not
    # help.
    if step_rad > most_rad > 0.0:
        yield (
            f"localization.heading_step_rad = {step_rad:g} is too coarse for readings of {sweep.reach_m:g} m: half a"
            f" step puts their ends farther to the side than any error radius reaches; take {_rounded_down(most_rad):g}"
        )
    apart_rad = math.tau / sweep.readings
    if sweep.between_beams is BetweenBeams.SEEN and apart_rad > APART_MAX_RAD:
        yield (
            f"sweep.readings = {sweep.readings} leave beams {math.degrees(apart_rad):.1f} degrees apart, too far to"
            f" tell what lies between: the map is full of holes that block; take {math.ceil(math.tau / APART_MAX_RAD)}"
        )
    if sweep.between_beams is BetweenBeams.UNSEEN and apart_rad * sweep.reach_m > settings.blocked_by * cell_m:
        yield (
            f'grid.between_beams = "unseen" leaves holes of {apart_rad * sweep.reach_m:.2g} m on cells of {cell_m:g} m'
            f' between beams of {sweep.reach_m:g} m, and they block; take "seen"'
        )


def _most_heading_step_rad(settings: LocalizationSettings, spec: GridSpec, reach_m: float) -> float:
    """Return how coarse headings may be so that half a step puts no head outside its error radius.

    None is fine enough where bearings alone err by more; then it is not positive.
    """
    if settings.error_radius is ErrorRadius.CONSTANT:
        return 2.0 * settings.range_error_m / reach_m
    # A radius serves as far as the middle between it and the next level, had it one.
    widest_m = radii_of(settings, spec).widest * spec.resolution_m
    return 2.0 * (widest_m / reach_m - (angle_error_rad(settings) - settings.heading_step_rad / 2.0))


def _rounded_down(angle_rad: float) -> float:
    """Return it to three places that count, none of which is rounded up."""
    unit = 10.0 ** (math.floor(math.log10(angle_rad)) - 2)
    return math.floor(angle_rad / unit) * unit
