"""In which order to take the bearings of a sweep of which few may be enough: to all sides first, then finer and finer.

A dozen readings to all sides tell more than a dozen in sequence, which see one wall. Steps of the golden section round
the circle leave no large gap after any number of them, so a sweep that is ended early has looked everywhere. It costs
the head a turn for each few readings; a sweep of which all is wanted is better taken in sequence.
"""

import math
from collections.abc import Sequence

_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


def spread_order(bearings: int) -> tuple[int, ...]:
    """Return the numbers of bearings that lie side by side, each once.

    >>> spread_order(8)
    (0, 5, 2, 7, 4, 1, 6, 3)
    """
    # By rank: places of the golden section fall between bearings, and none may be taken twice.
    places = [(number * _GOLDEN) % 1.0 for number in range(bearings)]
    ranks = {place: rank for rank, place in enumerate(sorted(places))}
    return tuple(ranks[place] for place in places)


def quadrants(bearings_rad: Sequence[float]) -> int:
    """Return in how many of the four quarters of a turn these bearings lie.

    >>> quadrants([0.1, 0.2, -0.1])
    2
    """
    return len({math.floor((bearing_rad % math.tau) / (math.pi / 2.0)) % 4 for bearing_rad in bearings_rad})
