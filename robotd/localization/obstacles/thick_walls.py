"""How walls are read that are drawn thicker than walls usually are."""

import enum


class ThickWalls(enum.StrEnum):
    """Where the face of a thick wall is."""

    AS_DRAWN = "as_drawn"
    """Where the map has it, as in the paper."""
    EITHER = "either"
    """There, or somewhere in the wall, as if drawn with a broad pen: the sweep says which."""
