"""What counts as one place for the second look, and how sure is sure."""

import math
from dataclasses import dataclass
from typing import Annotated

from robotd.core.bounds import Within, refuse_outside


@dataclass(frozen=True, slots=True)
class SecondLookSettings:
    """What counts as one place, and how sure is sure."""

    patch_m: Annotated[float, Within(0.001, 5.0, "m")] = 0.2
    """Readings that end nearer to each other than this say partly the same."""
    readings_max: Annotated[int, Within(1, 10_000)] = 120
    """Of more readings only this many are looked at, those that end farthest apart."""
    glance_readings_max: Annotated[int, Within(1, 10_000)] = 40
    """The same for the first glance, at all places of the shortlist."""
    starts_max: Annotated[int, Within(1, 100_000)] = 2000
    """Places at which the first glance is taken, those first that explain most readings."""
    places_max: Annotated[int, Within(1, 10_000)] = 64
    """Places that are looked at closely, those first that looked best at a glance."""
    same_within_m: Annotated[float, Within(0.001, 5.0, "m")] = 0.3
    """Poses nearer than this, and with headings nearer than ``same_within_rad``, are one place."""
    same_within_rad: Annotated[float, Within(0.001, math.pi, "rad")] = 0.0873
    """See ``same_within_m``."""
    off_map_share: Annotated[float, Within(1e-6, 0.49, "of 1")] = 0.1
    """Belief, before any reading, that the robot is not on the map."""
    doubt_max: Annotated[float, Within(1e-6, 0.49, "of 1")] = 0.05
    """All that is not the best place may have this share of the belief if the robot is to be called localized."""
    contrast_min: Annotated[float, Within(0.0, 100.0)] = 1.28
    """What the readings say for the best place, rather than any other, must be this many standard errors above 0: by
    chance the wrong one of two places that are alike in truth reaches that once in ten times."""
    contrast_beside_min: Annotated[float, Within(0.0, 100.0)] = 1.28
    """The same for places that see the same walls, a step to the side or a few degrees turned: along a corridor, or on
    coarse cells, belief alone chose between them."""
    contrast_nowhere_min: Annotated[float, Within(0.0, 100.0)] = 1.28
    """The same for being nowhere on the map, less what each of its many places lacks of belief beforehand: a small room
    that is not on it resembles some corner of it, and belief alone was sure of that."""
    on_walls_min: Annotated[float, Within(0.0, 1.0, "of 1")] = 0.9
    """Where fewer of the hits end on walls, the robot may look at ground that nobody has mapped, which resembles some
    wall of any building; then ``contrast_off_walls_min`` counts."""
    contrast_off_walls_min: Annotated[float, Within(0.0, 100.0)] = 3.0
    """The least contrast where many hits end on no wall, with places elsewhere and beside: by chance it is reached once
    in 700 times."""
    on_wall_m: Annotated[float, Within(0.001, 1.0, "m")] = 0.075
    """A hit is on a wall that is no farther than this, or than a cell and a half."""

    def __post_init__(self) -> None:
        """Refuse impossible values."""
        refuse_outside(self)
