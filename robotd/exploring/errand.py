"""What exploring a map was asked for and what came of it, beside the map itself: kept with it, to be gone on with."""

from dataclasses import dataclass, replace

from robotd.contract.ways import Point
from robotd.core.rectangle import Rectangle


@dataclass(frozen=True, slots=True)
class Errand:
    """How far exploring a map has come, whichever mission it was done by; map frame."""

    began_m: Point
    """Where the robot stood at first."""
    within: Rectangle | None = None
    """What is explored; None is all of the map."""
    asked_m: tuple[Point, ...] = ()
    """Stops that were asked for and that it has not gone to yet, in order."""
    in_vain_m: tuple[Point, ...] = ()
    """Goals that were not reached, and stops that brought nothing: not to be tried again."""

    def in_vain(self, place_m: Point) -> "Errand":
        """Return it with one more place that is not to be tried again."""
        return replace(self, in_vain_m=(*self.in_vain_m, place_m))

    def gone_to(self, place_m: Point) -> "Errand":
        """Return it with a stop done that was asked for, reached or not."""
        left_m = list(self.asked_m)
        # The first such: who asks for a place twice wants two looks.
        if place_m in left_m:
            left_m.remove(place_m)
        return replace(self, asked_m=tuple(left_m))
