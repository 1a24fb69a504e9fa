"""Why a robot that explores ends, and why it leaves an opening alone."""

import enum


class WhyEnded(enum.StrEnum):
    """The reasons for an end."""

    COMPLETE = "complete"
    """From nowhere that the robot can go is there an opening into the unknown that it could pass."""
    GOOD_ENOUGH = "good_enough"
    """The best place left would add next to nothing to what was seen."""
    UNREACHABLE = "unreachable"
    """Openings are left, and each was tried in vain or lies where no way leads."""
    BUDGET = "budget"
    """As many stops, or as long a way or a time, as were allowed."""
    LOST = "lost"
    """Sweep after sweep speaks against the map: the robot was carried, or its wheels lie beyond all bounds."""


class WhyLeft(enum.StrEnum):
    """What is in the way of an opening that is left."""

    NO_WAY = "no_way"
    """The robot does not come near it."""
    HIDDEN = "hidden"
    """Not enough of it is seen from where the robot fits."""
    IN_VAIN = "in_vain"
    """It was tried."""
    TO_DO = "to_do"
    """Exploring ended before."""
