"""A map on a terminal: two cells in each character, one above the other."""

import numpy as np
from numpy.typing import NDArray
from rich.text import Text

from robotd.grid.tables import NO_INFORMATION

_SHADES = ("#f4f6f7", "#7c878f", "#11161a")  # free, unknown, occupied
_BLOCKS = {(False, False): " ", (True, False): "▀", (False, True): "▄", (True, True): "█"}
_ASCII = {(False, False): " ", (True, False): "'", (False, True): ".", (True, True): "#"}


def shrink(occupancy: NDArray[np.uint8], columns: int) -> NDArray[np.uint8]:
    """Return the known part of a map ``uint8[rows, cols]``, at most ``columns`` wide, top row first.

    A block of cells shows its strongest evidence: walls do not vanish, and one free cell beats unknown ones.
    """
    known = np.argwhere(occupancy != NO_INFORMATION)
    if not len(known):
        return np.full((2, 2), NO_INFORMATION, np.uint8)
    (row_min, col_min), (row_max, col_max) = known.min(axis=0), known.max(axis=0)
    part = occupancy[row_min : row_max + 1, col_min : col_max + 1]
    step = -(-part.shape[1] // columns)
    rows, cols = (-(-side // step) for side in part.shape)
    rows += rows % 2
    padded = np.full((rows * step, cols * step), NO_INFORMATION, np.uint8)
    padded[: part.shape[0], : part.shape[1]] = part
    blocks = padded.reshape(rows, step, cols, step)
    highest, lowest = blocks.max(axis=(1, 3)), blocks.min(axis=(1, 3))
    strongest: NDArray[np.uint8] = np.where(highest > NO_INFORMATION, highest, lowest)
    return strongest[::-1]


def coloured(cells: NDArray[np.uint8]) -> Text:
    """Return a shrunken map as half blocks in white, grey and black."""
    text = Text()
    for upper, lower in zip(cells[0::2], cells[1::2], strict=True):
        for above, below in zip(upper, lower, strict=True):
            text.append("▀", style=f"{_shade(int(above))} on {_shade(int(below))}")
        text.append("\n")
    return text


def can_draw_blocks(encoding: str) -> bool:
    """Return whether a terminal of this encoding has half blocks.

    >>> can_draw_blocks("utf-8"), can_draw_blocks("ascii"), can_draw_blocks("iso-8859-1"), can_draw_blocks("cp437")
    (True, False, False, True)
    """
    try:
        "".join(_BLOCKS.values()).encode(encoding)
    except (UnicodeEncodeError, LookupError):
        return False
    return True


def plain(cells: NDArray[np.uint8], *, blocks: bool = True) -> str:
    """Return a shrunken map without colour: ink where there is an obstacle; without ``blocks`` in ASCII."""
    ink = _BLOCKS if blocks else _ASCII
    rows = zip(cells[0::2] > NO_INFORMATION, cells[1::2] > NO_INFORMATION, strict=True)
    return "\n".join("".join(ink[bool(a), bool(b)] for a, b in zip(*pair, strict=True)).rstrip() for pair in rows)


def _shade(value: int) -> str:
    return _SHADES[(value >= NO_INFORMATION) + (value > NO_INFORMATION)]
