"""A map on a terminal: two cells in each character, one above the other, with axes in metres and the robot.

Without colour a wall is ink, what is unknown is dotted and what is free is blank, so that the three differ.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from rich.text import Text

from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid.tables import NO_INFORMATION

_SHADES = ("#f4f6f7", "#7c878f", "#11161a")  # free, unknown, occupied
_BLOCKS = {(False, False): " ", (True, False): "▀", (False, True): "▄", (True, True): "█"}
_ASCII = {(False, False): " ", (True, False): "'", (False, True): ".", (True, True): "#"}
_UNKNOWN, _UNKNOWN_ASCII = "░", ":"
_ARROWS, _ARROWS_ASCII = "→↗↑↖←↙↓↘", ">/^\\</v\\"
_ROBOT_STYLE, _REGION_STYLE = "bold white on #c8102e", "bold white on #0b63ce"
_MARGIN = 9
"""Characters left of the map, for the axis."""
_ROWS_PER_TICK, _COLUMNS_PER_TICK = 4, 12


@dataclass(frozen=True, slots=True, eq=False)
class Shrunk:
    """The known part of a map, as large as it is drawn."""

    cells: NDArray[np.uint8]
    """``uint8[rows, cols]``, top row first; an even number of rows."""
    left_m: float
    """x of the left edge, map frame."""
    top_m: float
    """y of the upper edge, map frame."""
    cell_m: float

    def place(self, x_m: float, y_m: float) -> tuple[int, int]:
        """Return line and column of the character that a point lies in; they may be outside."""
        return math.floor((self.top_m - y_m) / (2.0 * self.cell_m)), math.floor((x_m - self.left_m) / self.cell_m)


def shrink(spec: GridSpec, occupancy: NDArray[np.uint8], columns: int) -> Shrunk:
    """Return the known part of a map ``uint8[rows, cols]``, at most ``columns`` characters wide with its axis.

    A block of cells shows its strongest evidence: walls do not vanish, and one free cell beats unknown ones.
    """
    columns = max(1, columns - _MARGIN)
    known = np.argwhere(occupancy != NO_INFORMATION)
    if not len(known):
        # Of a map of which nothing is known one unknown cell is shown, not an empty picture.
        known = np.array([[0, 0], [0, 0]])
    (row_min, col_min), (row_max, col_max) = known.min(axis=0), known.max(axis=0)
    part = occupancy[row_min : row_max + 1, col_min : col_max + 1]
    step = -(-part.shape[1] // columns)
    rows, cols = (-(-side // step) for side in part.shape)
    # Two rows share a character.
    rows += rows % 2
    padded = np.full((rows * step, cols * step), NO_INFORMATION, np.uint8)
    padded[: part.shape[0], : part.shape[1]] = part
    blocks = padded.reshape(rows, step, cols, step)
    highest, lowest = blocks.max(axis=(1, 3)), blocks.min(axis=(1, 3))
    strongest: NDArray[np.uint8] = np.where(highest > NO_INFORMATION, highest, lowest)
    left_m = spec.origin_x_m + float(col_min) * spec.resolution_m
    # Of the padded cells: they were added at the top.
    top_m = spec.origin_y_m + (float(row_min) + rows * step) * spec.resolution_m
    return Shrunk(strongest[::-1], left_m, top_m, step * spec.resolution_m)


@dataclass(frozen=True, slots=True)
class Ink:
    """What a terminal can draw with."""

    colour: bool
    blocks: bool


def draw(
    shrunk: Shrunk,
    ink: Ink,
    *,
    robot: Pose2 | None = None,
    places_m: Sequence[tuple[float, float]] = (),
    hits_m: Sequence[tuple[float, float]] = (),
) -> Text:
    """Return a map with its axes.

    Args:
        shrunk: what to draw.
        ink: with what.
        robot: where it is believed to be, if that is known.
        places_m: where else it may be, marked ``o``.
        hits_m: where a sweep met something, marked ``*``.
    """
    # The last one on a character is seen: the robot rather than a candidate, and that rather than a hit.
    marks = {shrunk.place(*at): ("*", _REGION_STYLE) for at in hits_m}
    marks |= {shrunk.place(*at): ("o", _REGION_STYLE) for at in places_m}
    if robot is not None:
        arrows = _ARROWS if ink.blocks else _ARROWS_ASCII
        arrow = arrows[round(robot.heading_rad / (math.pi / 4.0)) % 8]
        marks[shrunk.place(robot.x_m, robot.y_m)] = (arrow, _ROBOT_STYLE)
    text = Text()
    pairs = zip(shrunk.cells[0::2], shrunk.cells[1::2], strict=True)
    for line, (upper, lower) in enumerate(pairs):
        text.append(_tick(line, shrunk))
        for column, (above, below) in enumerate(zip(upper.tolist(), lower.tolist(), strict=True)):
            mark = marks.get((line, column))
            if mark is not None:
                text.append(mark[0], style=mark[1] if ink.colour else None)
            elif ink.colour and ink.blocks:
                text.append("▀", style=f"{_shade(above)} on {_shade(below)}")
            else:
                text.append(_plain(above, below, ink))
        text.append("\n")
    return text.append(_axis(shrunk))


def can_draw_blocks(encoding: str) -> bool:
    """Return whether a terminal of this encoding has half blocks.

    >>> can_draw_blocks("utf-8"), can_draw_blocks("ascii"), can_draw_blocks("iso-8859-1")
    (True, False, False)
    """
    try:
        "".join((*_BLOCKS.values(), _UNKNOWN, _ARROWS)).encode(encoding)
    except (UnicodeEncodeError, LookupError):
        return False
    return True


def _plain(above: int, below: int, ink: Ink) -> str:
    is_wall = above > NO_INFORMATION, below > NO_INFORMATION
    if any(is_wall):
        return (_BLOCKS if ink.blocks else _ASCII)[is_wall]
    if above == below == NO_INFORMATION:
        return _UNKNOWN if ink.blocks else _UNKNOWN_ASCII
    return " "


def _shade(value: int) -> str:
    return _SHADES[(value >= NO_INFORMATION) + (value > NO_INFORMATION)]


def _tick(line: int, shrunk: Shrunk) -> str:
    """Return what stands left of a line: on some its height in metres, in the middle of the character."""
    if line % _ROWS_PER_TICK:
        return " " * (_MARGIN - 1) + "|"
    return f"{shrunk.top_m - (2 * line + 1) * shrunk.cell_m:{_MARGIN - 1}.2f}|"


def _axis(shrunk: Shrunk) -> str:
    """Return the line below the map: from some columns on their x in metres."""
    cols = shrunk.cells.shape[1]
    labels = (f"|{shrunk.left_m + at * shrunk.cell_m:.2f}" for at in range(0, cols, _COLUMNS_PER_TICK))
    return " " * (_MARGIN - 1) + "".join(f"{label:{_COLUMNS_PER_TICK}}" for label in labels).rstrip() + " m"
