"""Numbers as a strip of bars: how many lie where."""

import numpy as np
from numpy.typing import NDArray

_BARS, _ASCII = " ▁▂▃▄▅▆▇█", " .:-=+*%#"
_WIDTH = 41


def strip(values: NDArray[np.float64], reach: float, *, blocks: bool = True) -> str:
    """Return a histogram from ``-reach`` to ``reach``; what lies beyond counts at its end.

    >>> strip(np.array([0.0, 0.0, -1.0]), 1.0, blocks=False)
    '=                   #                    '
    """
    cells = np.round((np.clip(values / reach, -1.0, 1.0) + 1.0) / 2.0 * (_WIDTH - 1)).astype(int)
    counts = np.bincount(cells, minlength=_WIDTH)
    heights = np.ceil(counts / max(1, counts.max()) * 8.0).astype(int)
    return "".join((_BARS if blocks else _ASCII)[height] for height in heights)
