"""How the error radius of readings is chosen."""

import enum


class ErrorRadius(enum.StrEnum):
    """Whether all readings have one error radius."""

    CONSTANT = "constant"
    """The paper's eps, whatever the range and the cells are."""
    BY_RANGE = "by_range"
    """The farther the head lies, the farther off an angle puts it; and never less than what cells round away."""
