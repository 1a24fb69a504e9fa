"""What exploring knows beside the map: where it was in vain, and what the laser does not see."""

from dataclasses import dataclass, replace

from robotd.contract.ways import Point


@dataclass(frozen=True, slots=True)
class Tried:
    """Places, map frame."""

    in_vain_m: tuple[Point, ...] = ()
    """Goals that were not reached, and stops that brought nothing: not to be tried again."""
    met_m: tuple[Point, ...] = ()
    """What was bumped into, or seen on a leg that the map has free: obstacles, whatever the map says."""

    def in_vain(self, place_m: Point) -> "Tried":
        """Return it with one more place that is not to be tried again."""
        return replace(self, in_vain_m=(*self.in_vain_m, place_m))

    def met(self, places_m: tuple[Point, ...]) -> "Tried":
        """Return it with more obstacles."""
        return replace(self, met_m=(*self.met_m, *places_m))
