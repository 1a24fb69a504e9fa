"""What exploring knows beside the map: where it was in vain, and what the laser does not see."""

from dataclasses import dataclass

from robotd.contract.ways import Point


@dataclass(frozen=True, slots=True)
class Tried:
    """Places, map frame."""

    in_vain_m: tuple[Point, ...] = ()
    """Goals that were not reached, and stops that brought nothing: not to be tried again."""
    met_m: tuple[Point, ...] = ()
    """What was bumped into, or seen on a leg that the map has free: obstacles, whatever the map says."""
