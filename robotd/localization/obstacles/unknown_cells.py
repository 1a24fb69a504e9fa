"""What localization takes a cell for that nobody has seen."""

import enum


class UnknownCells(enum.StrEnum):
    """What a cell is taken for that nobody has seen."""

    OCCUPIED = "occupied"
    """An obstacle, as in the paper."""
    BLOCKS_ONLY = "blocks_only"
    """It stops every beam, but no reading can end in it."""
    FREE = "free"
    """No obstacle; but the robot does not stand there either."""
