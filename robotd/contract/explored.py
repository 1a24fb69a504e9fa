"""What a robot that explores tells of its choices: where it may stop, and what is left open."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class CandidateStop:
    """A place where the next stop may be, map frame."""

    x_m: float
    y_m: float
    score: float
    """Ground that it is expected to add, over the time that it takes to go there and sweep [m2/s]."""
    area_m2: float
    """Ground that it is expected to add."""
    opening_m: float
    """How much of the border of what was seen can be looked through from there."""
    overlap: float
    """Share of the beams that would end on known walls, 0 to 1: by these the sweep finds its place."""
    way_m: float
    """From where the robot stands."""


@dataclass(frozen=True, slots=True)
class LeftOpen:
    """An opening into the unknown that is left, map frame."""

    x_m: float
    y_m: float
    width_m: float
    why: str
    """``no_way`` (the robot does not come near), ``hidden`` (not enough is seen of it from where the robot fits),
    ``in_vain`` (it was tried) or ``to_do`` (exploring ended before)."""


@dataclass(frozen=True, slots=True)
class StopChosen:
    """Where a robot that explores goes next, and what else there was."""

    time_ns: int
    map_id: str
    stop: int
    """From 0, of this mission."""
    x_m: float
    y_m: float
    reason: str
    """For people."""
    candidates: tuple[CandidateStop, ...]
    """Where it goes, then the others that it was chosen from, the best first, up to twelve; empty of a stop that a
    client asked for."""
    tour_m: tuple[tuple[float, float], ...] = ()
    """Where it means to stop from now on to see all that is open by now, in order; each stop changes its mind."""


@dataclass(frozen=True, slots=True)
class ExploringEnded:
    """Why exploring ended, and what could not be seen."""

    time_ns: int
    map_id: str
    ending: str
    """``complete`` (no opening is left), ``good_enough`` (none is worth a stop), ``unreachable`` (all that are left
    were tried or lie where no way leads), ``budget`` or ``lost``."""
    stops: int
    """Made by this mission."""
    way_m: float
    seen_m2: float
    """Free ground on the map."""
    left: tuple[LeftOpen, ...]
    """The widest first."""

    @property
    def words(self) -> str:
        """Say it in a line."""
        left = f"; {len(self.left)} openings are left" if self.left else ""
        done = f"{self.stops} stops, {self.way_m:.1f} m of way, {self.seen_m2:.1f} m2 seen"
        return f"{ENDINGS.get(self.ending, self.ending)}: {done}{left}"


ENDINGS = {
    "complete": "all was seen",
    "good_enough": "nothing that is left is worth a stop",
    "unreachable": "what is left cannot be seen from where the robot can go",
    "budget": "the budget is used up",
    "lost": "lost: sweep after sweep speaks against the map",
}
"""Why it ended, for people."""
WHYS = {
    "no_way": "no way leads near",
    "hidden": "too little of it is seen from where the robot fits",
    "in_vain": "tried in vain",
    "to_do": "to do",
}
"""Why something is left open, for people."""
