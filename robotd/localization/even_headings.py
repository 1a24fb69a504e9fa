"""Headings all round, where nothing is known of the heading."""

import math


def even_headings(count: int) -> tuple[float, ...]:
    """Return theta slices all round, ``2 pi k / count`` ([BrownDonald2000]_ sec. 2.2.3)."""
    return tuple(math.tau * k / count for k in range(count))
