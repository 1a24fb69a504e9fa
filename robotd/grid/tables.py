"""How evidence changes a cell: exponential decay, as two 256-entry look-up tables ([BrownDonald2000]_ sec. 3.2).

A cell is a 256-state machine: 0 is surely vacant, 255 surely occupied, 128 means "no information". Two facts
about the rounding are promised and tested: from every state, repeated updates arrive at 0 or 255 (no state
traps a cell), and no update arrives at 128, so a cell of value 128 has never been seen.
"""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

NO_INFORMATION = 128
"""The value of a cell that was never updated."""
SURELY_OCCUPIED = 255

UpdateTable: TypeAlias = NDArray[np.uint8]
"""``uint8[256]``: the next value of a cell, by its present one."""


def lower_table(alpha: float) -> UpdateTable:
    """Return the table of ``p <- alpha p``: a beam went through the cell.

    Args:
        alpha: share of the probability that is left, ``0 <= alpha < 1``; small forgets fast.

    Raises:
        ValueError: ``alpha`` is out of range.
    """
    lowered = _decayed(alpha)
    # Whatever was seen must not look like what never was.
    lowered[lowered == NO_INFORMATION] = NO_INFORMATION - 1
    return lowered


def raise_table(alpha: float) -> UpdateTable:
    """Return the table of ``p <- 1 - alpha (1 - p)``: a beam ended in the cell; else as :func:`lower_table`."""
    # Raising an obstacle's chance is lowering that of a vacant cell: the same decay, counted from 255.
    raised: UpdateTable = SURELY_OCCUPIED - _decayed(alpha)[::-1]
    raised[raised == NO_INFORMATION] = NO_INFORMATION + 1
    return raised


def _decayed(alpha: float) -> UpdateTable:
    """Return ``alpha`` times each state, rounded to the nearest but always at least one nearer to 0."""
    if not 0.0 <= alpha < 1.0:
        raise ValueError(f"alpha must be at least 0 and less than 1, got {alpha}")
    states = np.arange(256)
    # Rounding alone would trap small states: with alpha 0.85, a 3 becomes 2.55 and is a 3 again.
    decayed: UpdateTable = np.minimum(np.rint(alpha * states), np.maximum(states - 1, 0)).astype(np.uint8)
    return decayed
