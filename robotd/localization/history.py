"""Where the robot can be at all, carried from stop to stop: places that it cannot have come from are none.

One look round in a building of rooms that are alike leaves several places, and no look will ever leave fewer where the
rooms are alike in truth. The way between two looks does: of the places that the second one leaves, only those count
that can be reached from a place that the first one left, by what the wheels say, give or take what wheels err by right
(:class:`~robotd.core.motion_error.MotionError`). So each member of a history is a box of poses; it is moved as the
robot moved, grown by the bounds of way and turn, and meets the regions of the next look.

Nothing is excluded because evidence merely dislikes it. A look that may have left a place out excludes nothing. So
where regions are proven (the conservative mode), and as long as the wheels keep their bounds, the true pose is never
lost. If no region can be reached, one of both is not true: the robot was carried, or its wheels slipped by more than
they may. That is a :class:`~robotd.contract.estimate.Contradiction`, seen at the first look after it.

Pure: what was known and a look in, what is known out.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from robotd.contract.estimate import Contradiction, Extent, Region
from robotd.core.angles import wrap_rad
from robotd.core.motion_error import MotionError, Travel
from robotd.core.pose import IDENTITY, Pose2

_MEMBERS_MAX = 64
"""Boxes that are carried; where more would be, each region is one."""
_MATCHING_M, _MATCHING_RAD = 0.15, math.radians(3.0)
"""How far beside a region the robot may stand: cells and headings are rounded, and maps are off by as much."""
_RIVAL_LOOKS = 2
"""Looks for which what was believed before a contradiction stays a rival of what was found."""
_LEAST_BELIEF = 1e-12
"""Of a place that the second look did not look at."""


@dataclass(frozen=True, slots=True)
class Member:
    """One box of poses that the robot may be in."""

    extent: Extent
    evidence: float = 0.0
    """Logarithm of the belief in it, summed over the looks, less that of the best; it orders, and excludes nothing."""
    looks_left: int | None = None
    """Looks after which it is given up unless one bears it out; None for what no look has contradicted."""


@dataclass(frozen=True, slots=True)
class Looked:
    """What a look made of a history."""

    history: "History"
    reachable: tuple[bool, ...]
    """Whether the robot can have come to each region; all are where nothing may be excluded."""
    contradiction: Contradiction | None = None
    """Why no region can be reached; then the history holds the regions and, as rivals, what was believed before."""

    @property
    def only(self) -> int | None:
        """The number of the one region that can be reached; None if there are several, or a contradiction."""
        is_one = self.contradiction is None and sum(self.reachable) == 1
        return self.reachable.index(True) if is_one else None


@dataclass(frozen=True, slots=True)
class History:
    """All that the robot may be in, best first; without members it may be anywhere."""

    members: tuple[Member, ...] = ()

    @classmethod
    def at(cls, pose: Pose2, near_m: float, near_rad: float) -> "History":
        """Return the history of a robot that somebody, or something else than a look, has placed there."""
        x_m, y_m = pose.x_m, pose.y_m
        headings = _turned(pose.heading_rad - near_rad, 2.0 * near_rad)
        return cls((Member(Extent(x_m - near_m, x_m + near_m, y_m - near_m, y_m + near_m, *headings)),))

    @property
    def is_anywhere(self) -> bool:
        """Whether nothing is excluded."""
        return not self.members

    def moved(self, travel: Travel, motion: MotionError) -> "History":
        """Return where the robot may be after some travel: bounds are grown by what wheels may err by."""
        return History(tuple(replace(one, extent=reached(one.extent, travel, motion)) for one in self.members))

    def looked(
        self, regions: Sequence[Region], travel: Travel, motion: MotionError, *, is_complete: bool = True
    ) -> Looked:
        """Return what is known after a look round.

        Args:
            regions: the places that it leaves, best first; none if it believes in no place.
            travel: since the look before.
            motion: what the wheels may err by.
            is_complete: whether no further place is left beside these.
        """
        moved = self.moved(travel, motion)
        # A list that was cut may lack the true place, so its silence about a member says nothing.
        if not (regions and is_complete):
            return Looked(moved, (True,) * len(regions))
        # Grown before they are met with what is carried: cells and headings are rounded, and the map errs by as
        # much.
        found = [Member(_grown(region.extent, _MATCHING_M, _MATCHING_RAD), _evidence(region)) for region in regions]
        if self.is_anywhere:
            return Looked(History(_ordered(found)), (True,) * len(found))
        met = [_met(one, moved.members) for one in found]
        if any(met):
            kept = [member for pieces in met for member in pieces]
            if len(kept) > _MEMBERS_MAX:
                # A region holds all that it has in common with any member.
                best = [
                    (one, max(piece.evidence for piece in pieces))
                    for one, pieces in zip(found, met, strict=True)
                    if pieces
                ]
                kept = [replace(one, evidence=evidence) for one, evidence in best]
            return Looked(History(_ordered(kept + _fading(moved.members, kept))), tuple(map(bool, met)))
        # What was believed is not thrown away by one look: a look that found a wrong place would else have the
        # last word.
        rivals = [replace(one, looks_left=_RIVAL_LOOKS) for one in moved.members if one.looks_left is None]
        history = History(_ordered([*found, *rivals, *_fading(moved.members, [])]))
        # As far again, and it is not the wheels any more.
        further = moved.moved(replace(travel, step=IDENTITY), motion)
        slipped = any(_met(one, further.members) for one in found)
        return Looked(history, (False,) * len(found), Contradiction.SLIPPED if slipped else Contradiction.CARRIED)


def reached(extent: Extent, travel: Travel, motion: MotionError) -> Extent:
    """Return the box round every pose to which a pose of a box may have come by some travel."""
    off_m, off_rad = motion.bounds(travel)
    # The heading is not known exactly, so the step may lead anywhere along an arc: its box is that of the arc.
    way_m, towards_rad = math.hypot(travel.step.x_m, travel.step.y_m), math.atan2(travel.step.y_m, travel.step.x_m)
    low_rad, width_rad = extent.heading_min_rad + towards_rad, extent.heading_max_rad - extent.heading_min_rad
    x_least, x_most = _cosines(low_rad, width_rad)
    y_least, y_most = _cosines(low_rad - math.pi / 2.0, width_rad)
    return Extent(
        extent.x_min_m + way_m * x_least - off_m,
        extent.x_max_m + way_m * x_most + off_m,
        extent.y_min_m + way_m * y_least - off_m,
        extent.y_max_m + way_m * y_most + off_m,
        *_turned(extent.heading_min_rad + travel.step.heading_rad - off_rad, width_rad + 2.0 * off_rad),
    )


def shared(one: Extent, other: Extent) -> Extent | None:
    """Return a box round all poses that two boxes have in common; None if there are none."""
    x_min_m, x_max_m = max(one.x_min_m, other.x_min_m), min(one.x_max_m, other.x_max_m)
    y_min_m, y_max_m = max(one.y_min_m, other.y_min_m), min(one.y_max_m, other.y_max_m)
    headings = _shared_headings(one, other)
    if x_min_m > x_max_m or y_min_m > y_max_m or headings is None:
        return None
    return Extent(x_min_m, x_max_m, y_min_m, y_max_m, *headings)


def _shared_headings(one: Extent, other: Extent) -> tuple[float, float] | None:
    width_rad = one.heading_max_rad - one.heading_min_rad
    other_width_rad = other.heading_max_rad - other.heading_min_rad
    # Counted from where the first begins: on a circle there is no other order of four ends.
    after_rad = (other.heading_min_rad - one.heading_min_rad) % math.tau
    pieces = [
        (max(0.0, low_rad), min(width_rad, low_rad + other_width_rad)) for low_rad in (after_rad, after_rad - math.tau)
    ]
    pieces = [(low_rad, high_rad) for low_rad, high_rad in pieces if low_rad <= high_rad]
    if len(pieces) == 2:
        # Two wide fans that meet at both ends: the narrower one holds both pieces.
        narrow = one if width_rad <= other_width_rad else other
        return narrow.heading_min_rad, narrow.heading_max_rad
    return _turned(one.heading_min_rad + pieces[0][0], pieces[0][1] - pieces[0][0]) if pieces else None


def _turned(low_rad: float, width_rad: float) -> tuple[float, float]:
    """Return the headings from one on, counter-clockwise, as an extent has them."""
    if width_rad >= math.tau:
        return -math.pi, math.pi
    low_rad = wrap_rad(low_rad)
    return low_rad, low_rad + width_rad


def _cosines(low_rad: float, width_rad: float) -> tuple[float, float]:
    """Return the least and the greatest cosine of the angles from one on."""
    low_rad %= math.tau
    high_rad = low_rad + width_rad
    ends = math.cos(low_rad), math.cos(high_rad)
    has_most = low_rad <= 0.0 or high_rad >= math.tau
    has_least = low_rad <= math.pi <= high_rad or high_rad >= 3.0 * math.pi
    return -1.0 if has_least else min(ends), 1.0 if has_most else max(ends)


def _grown(extent: Extent, by_m: float, by_rad: float) -> Extent:
    width_rad = extent.heading_max_rad - extent.heading_min_rad + 2.0 * by_rad
    return Extent(
        *(extent.x_min_m - by_m, extent.x_max_m + by_m, extent.y_min_m - by_m, extent.y_max_m + by_m),
        *_turned(extent.heading_min_rad - by_rad, width_rad),
    )


def _evidence(region: Region) -> float:
    return math.log(max(region.belief, _LEAST_BELIEF))


def _met(found: Member, members: Sequence[Member]) -> list[Member]:
    """Return what a region has in common with each member, for those with which it has anything."""
    pairs = ((shared(found.extent, member.extent), member) for member in members)
    return [Member(both, found.evidence + member.evidence) for both, member in pairs if both is not None]


def _fading(members: Sequence[Member], met: Sequence[Member]) -> list[Member]:
    """Return the rivals of a contradiction that no look has borne out, one look nearer to their end."""
    left = [
        replace(one, looks_left=one.looks_left - 1)
        for one in members
        if one.looks_left is not None and one.looks_left > 1
    ]
    # What was borne out is among those met already.
    return [one for one in left if not any(shared(one.extent, other.extent) for other in met)]


def _ordered(members: Sequence[Member]) -> tuple[Member, ...]:
    """Return members, best first; evidence counts from the best one, so that no sum grows without end."""
    best = max(one.evidence for one in members)
    counted = (replace(one, evidence=one.evidence - best) for one in members)
    # What a look found comes before what it contradicted; stable, so the order of equals is that of the regions.
    return tuple(sorted(counted, key=lambda one: (one.looks_left is not None, -one.evidence)))
