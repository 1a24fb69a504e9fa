"""How far poses are from what is known of how they lie to each other."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from robotd.core.pose import Pose2
from robotd.logs.relations import Relation


@dataclass(frozen=True, slots=True)
class Spread:
    """Mean, standard deviation and largest of some errors."""

    mean: float
    deviation: float
    largest: float

    @classmethod
    def of(cls, errors: Sequence[float]) -> "Spread":
        """Sum errors up, at least one."""
        return cls(float(np.mean(errors)), float(np.std(errors)), float(np.max(errors)))


@dataclass(frozen=True, slots=True)
class RelationErrors:
    """How far a survey of a log is from the relations that were checked by hand, over all of them."""

    metres: Spread
    radians: Spread

    @classmethod
    def of(cls, relations: Iterable[Relation], poses: Mapping[int, Pose2] | Sequence[Pose2]) -> "RelationErrors":
        """Compare where pairs of scans lie to each other with where they should; poses by number of the scan."""
        # Pairs, not places: a heading that is off early must not count once more at every scan after it.
        offs = [
            relation.step.inverse() @ (poses[relation.one].inverse() @ poses[relation.other]) for relation in relations
        ]
        metres = Spread.of([math.hypot(off.x_m, off.y_m) for off in offs])
        return cls(metres, Spread.of([abs(off.heading_rad) for off in offs]))
