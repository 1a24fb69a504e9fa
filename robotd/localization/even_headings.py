"""Headings all round, where nothing is known of the heading."""

import math


def even_headings(count: int) -> tuple[float, ...]:
    """Return theta slices all round, ``2 pi k / count`` ([BrownDonald2000]_ sec. 2.2.3)."""
    # From k times the whole and not by adding steps, whose rounding errors would add up to a gap at the end.
    return tuple(math.tau * k / count for k in range(count))
