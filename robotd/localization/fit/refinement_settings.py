"""How poses are refined."""

import enum
from dataclasses import dataclass
from typing import Annotated

from robotd.core.bounds import Within, refuse_outside


class Walls(enum.StrEnum):
    """Where in its cells a wall lies."""

    FACES = "faces"
    """At the sides of its cells: a drawn map, whose cells are the truth."""
    CENTRES = "centres"
    """Along the middle of its cells: a map made of readings, whose heads lie anywhere in the cells they raised."""


@dataclass(frozen=True, slots=True)
class RefinementSettings:
    """How poses are refined."""

    walls: Walls = Walls.CENTRES
    """Where in its cells a wall lies: ``centres`` for a map made of readings, ``faces`` for a drawn one."""
    outlier_m: Annotated[float, Within(0.001, 5.0, "m")] = 0.2
    """A reading whose head is farther than this from every wall has no say."""
    map_error_m: Annotated[float, Within(0.0, 1.0, "m")] = 0.02
    """How far the walls of the map may be off, all together: the standard deviation of x and y is no less."""
    map_error_rad: Annotated[float, Within(0.0, 0.5, "rad")] = 0.005
    """The same for the heading."""

    def __post_init__(self) -> None:
        """Refuse impossible values."""
        refuse_outside(self)
