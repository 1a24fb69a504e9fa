"""Counting poses that cannot be excluded, in NumPy: the twin of the kernel in C."""

import functools
import operator
from collections.abc import Iterator, Sequence

import numpy as np

from robotd.grid.fans import FanBeams
from robotd.grid.kernels.shared.packed_counting import ripple, seen_from, tiles_of_plane
from robotd.grid.kernels.shared.packed_map import PackedMap, Words


def count_fans(
    counters: Words,
    the_map: PackedMap,
    grown: Sequence[Words],
    fan_beams: FanBeams,
    *,
    subtract: bool = False,
    threads: int = 1,  # noqa: ARG001  # one thread is all that this needs
) -> None:
    """See :class:`.FansKernel`."""
    free = seen_from(the_map.free, 0, 0)
    for fan in range(len(fan_beams.fans.lines)):
        beams = fan_beams.beams[fan_beams.lists[fan] : fan_beams.lists[fan + 1]].tolist()
        longest = beams[-1][0] if beams else 0
        fronts, crossed, passed = _fronts(the_map, fan_beams, fan, longest), 0, free
        for lines, heading, radius, row, col in beams:
            # Beams come by how many lines they cross, so each line of the fan is worked out once for all of them.
            while crossed < lines:
                passed, crossed = passed & next(fronts), crossed + 1
            possible = passed if radius < 0 else passed & seen_from(grown[radius], row, col)
            ripple(counters[:, heading], tiles_of_plane(possible, the_map), subtract=subtract)


def _fronts(the_map: PackedMap, fan_beams: FanBeams, fan: int, count: int) -> Iterator[Words]:
    """Yield line after line from which cells a path leads there."""
    axis, forward, first, least, greatest, window, at_home = fan_beams.fans.lines[fan].tolist()

    def line_at(along: int, low: int, high: int) -> dict[int, Words]:
        offsets = {aside: (along, aside) if axis == 0 else (aside, along) for aside in range(low - 1, high + 2)}
        return {aside: ~seen_from(the_map.blocking, *offset) for aside, offset in offsets.items()}

    before = line_at(0, 0, 0)
    paths = {0: before[0]} if at_home else None
    for number, (low, high) in enumerate(fan_beams.fans.windows[window : window + count].tolist()):
        here = line_at(forward * (first + number), low, high)
        steps = (low, high) if number == 0 else (least, greatest)
        paths = {aside: here[aside] & _arriving(paths, before, here, aside, steps) for aside in range(low, high + 1)}
        before = here
        yield functools.reduce(operator.or_, paths.values())


def _arriving(
    paths: dict[int, Words] | None, before: dict[int, Words], here: dict[int, Words], aside: int, steps: tuple[int, int]
) -> Words:
    """Return which paths can step to a cell; from nowhere, they begin there.

    A path that steps sideways leaves a cell by its side or by its front: one of these two neighbours is open.
    """
    if paths is None:
        return np.full_like(here[aside], ~np.uint64(0))
    arriving = np.zeros_like(here[aside])
    for old, path in paths.items():
        if not steps[0] <= aside - old <= steps[1]:
            continue
        straight = old == aside or old not in here
        arriving |= path if straight else path & (before[old + (1 if aside > old else -1)] | here[old])
    return arriving
