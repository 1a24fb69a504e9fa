"""Which headings are tried where nothing is known of the heading."""

import enum


class HeadingSearch(enum.StrEnum):
    """Which headings are tried where nothing is known of the heading."""

    ALL = "all"
    """All of them, in steps of ``heading_step_rad``."""
    WALLS = "walls"
    """Those under which the walls that the readings show run as the walls of the map do; all where that has no answer.
    Where the walls seen have another axis than those of the map, as furniture has, the true heading is not tried."""
