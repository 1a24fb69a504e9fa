"""How a robot explores; the same for all buildings."""

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ExploringSettings:
    """What a stop must be worth. The reasons are in ``docs/finding-its-way.md``."""

    lattice_m: float = 0.25
    """Candidates lie this far apart, along either axis."""
    apart_m: float = 0.3
    """No stop is made nearer than this to one that was made, or tried in vain."""
    beams: int = 180
    """Cast round each candidate."""
    opening_min_m: float = 0.6
    """Nothing narrower is an opening: the robot would not pass, and wrong ranges leave many slits."""
    overlap_min: float = 0.65
    """Share of the beams that must end on known walls, where any candidate has as many: the sweep must find its place.
    """
    depth_max_m: float = 2.0
    """However wide an opening is, a beam into it meets something after this, on average, as far as anybody can tell."""
    stretch_m: float = 0.5
    """The border is told apart by squares of this side: which stop looks behind which of them."""
    good_enough: float = 0.02
    """Share of what was seen; if no stop is expected to add more, it is enough."""
    good_enough_max_m2: float = 1.0
    """It is not, if one is expected to add this much: that may be a door, however large the building is."""
    shown: int = 12
    """This many candidates are told, the best first."""

    @property
    def step_rad(self) -> float:
        """Between two beams."""
        return math.tau / self.beams


@dataclass(frozen=True, slots=True)
class Pace:
    """How fast this robot is."""

    sweep_s: float = 30.0
    """For a whole sweep."""
    speed_mps: float = 0.3
    turn_radps: float = 0.5

    def seconds(self, way_m: float, turn_rad: float) -> float:
        """Return how long it takes to turn, go there, and sweep."""
        return self.sweep_s + way_m / self.speed_mps + turn_rad / self.turn_radps
