"""What may come of placing a sweep on a map that is young."""

import enum


class Outcome(enum.StrEnum):
    """What came of placing a sweep."""

    PLACED = "placed"
    """The map explains it near where odometry says."""
    WIDE = "wide"
    """The map explains it, farther off than odometry errs."""
    WEAK = "weak"
    """The map explains part of it."""
    NEW_GROUND = "new_ground"
    """The map says next to nothing of it: odometry's word stands."""
    CONTRADICTS = "contradicts"
    """The map speaks against it, wherever the robot may have been: it is not laid into the map."""

    @property
    def is_found(self) -> bool:
        """Whether the map had a word in it."""
        return self in {Outcome.PLACED, Outcome.WIDE, Outcome.WEAK}
