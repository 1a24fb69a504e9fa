"""Maps as pictures for people and other programs: PGM, and the three greys of ROS's map_server.

Pure: cells in, bytes out. A picture's top row is the one of largest y; arrays in the daemon begin with the
smallest. The flip happens in :func:`encode_pgm` and nowhere else.
"""

import numpy as np
from numpy.typing import NDArray

OCCUPIED_THRESH = 0.65
"""map_server's own figure."""
FREE_THRESH = 0.196
"""map_server's own figure; with the 0.25 that it also accepts, an unknown pixel of 205 would load as free."""
OCCUPIED_GREY, UNKNOWN_GREY, FREE_GREY = 0, 205, 254

_SURE = 255


def encode_pgm(grey: NDArray[np.uint8]) -> memoryview:
    """Return the binary PGM (P5) of ``uint8[rows, cols]`` whose row 0 has the smallest y."""
    rows, cols = grey.shape
    header = b"P5\n%d %d\n255\n" % (cols, rows)
    found = np.empty(len(header) + grey.size, np.uint8)  # bytes put together would keep other threads waiting
    found[: len(header)] = np.frombuffer(header, np.uint8)
    found[len(header) :].reshape(rows, cols)[:] = grey[::-1]
    return found.data


def trinary_from_cells(cells: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return map_server's three greys for 8-bit cells, with ``p = value / 255`` as the probability of an obstacle.

    ``p >= 0.65`` (166 and more) is black, ``p <= 0.196`` (49 and less) is white, and what lies between is 205,
    unknown: 128, which is a cell never seen, and cells whose evidence is too weak or contradicts itself.
    """
    probability = np.arange(256) / _SURE
    grey = np.full(256, UNKNOWN_GREY, np.uint8)
    grey[probability >= OCCUPIED_THRESH] = OCCUPIED_GREY
    grey[probability <= FREE_THRESH] = FREE_GREY
    found = np.empty_like(cells)
    for row, line in enumerate(cells):  # all at once would make an index of eight bytes for each cell
        found[row] = grey[line]
    return found
