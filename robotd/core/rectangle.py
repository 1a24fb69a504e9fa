"""A rectangle in metres: what pictures show, and how far a region of an arrangement reaches."""

from typing import NamedTuple


class Rectangle(NamedTuple):
    """Sides along the axes, map frame; infinite where it has no end."""

    west_m: float
    south_m: float
    east_m: float
    north_m: float
