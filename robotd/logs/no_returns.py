"""Which ranges say that nothing came back: a limit that the log names, or a code that shows by itself."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from robotd.core.pose import Pose2
from robotd.logs.bearings import names

_CODES_FROM_M = 30.0
_CODE_SPREAD_M = 0.2
_SAME_M = 0.0015
"""Ranges are written to the millimetre or coarser."""
_BESIDE_M = 0.5
_PILE_MIN = 10
_PILE_PLACES = 3
_PLACE_M = 0.2
_PILE_SHARE = 0.05
"""Of all ranges: a pile like that is a code, even if the robot never moved."""
_PILE_SHARE_MAX = 0.9
"""Where nearly all ranges are the same, they may well be distances: in a round room, or in a test."""


_Ranges = NDArray[np.float64]


def named_limit_m(params: Mapping[str, str], scanner: str) -> float:
    """Return the largest range that a PARAM names; ``inf`` without one, and 0 is none."""
    for name in (*names(scanner, "max"), *names(scanner, "maxrange"), *names(scanner, "max_range")):
        try:
            limit_m = float(params.get(name, ""))
        except ValueError:
            continue
        if limit_m > 0.0:
            return limit_m
    return math.inf


def code_from_m(scans_m: Sequence[_Ranges], poses: Sequence[Pose2], limits_m: Sequence[float]) -> float:
    """Return from which range on a scanner says that nothing came back; ``inf`` if it has no code for that.

    Args:
        scans_m: the ranges of each scan.
        poses: where each was taken.
        limits_m: the range of each from which on nothing was met, as the log says; ``inf`` where it does not.

    From 30 m on whatever lies within 0.2 m of the largest range is a code, as no such scanner sees a wall there
    indoors, and codes vary a little; a log that names a limit itself has its codes beyond that. Else the largest range
    is one if it stands in a pile: often, from several places (no wall is equally far from all), and more often than
    all the half metre below it.
    """
    from_m = math.inf
    below = _below(scans_m, limits_m)
    largest_m = _largest_m(below)
    # Only where the log names no limit: with one, whatever lies below it is a distance, however far.
    if largest_m > _CODES_FROM_M and all(map(math.isinf, limits_m)):
        from_m = largest_m - _CODE_SPREAD_M
        below = _below(scans_m, [from_m] * len(scans_m))
        largest_m = _largest_m(below)
    is_pile = largest_m > 0.0 and _is_pile(below, poses, largest_m)
    return largest_m - _SAME_M if is_pile else from_m


def code_remark(from_m: float) -> tuple[str, ...]:
    """Return what people must be told of a code, if there is one."""
    words = (
        f"ranges from {from_m:.2f} m on are the scanner's code for nothing came back; --range-max says what they are"
    )
    return (words,) if math.isfinite(from_m) else ()


def _below(scans_m: Sequence[_Ranges], limits_m: Sequence[float]) -> list[_Ranges]:
    pairs = zip(scans_m, limits_m, strict=True)
    return [ranges_m[(ranges_m > 0.0) & (ranges_m < limit_m)] for ranges_m, limit_m in pairs]


def _largest_m(below: Sequence[_Ranges]) -> float:
    return max((float(ranges_m.max()) for ranges_m in below if len(ranges_m)), default=0.0)


def _is_pile(below: Sequence[_Ranges], poses: Sequence[Pose2], largest_m: float) -> bool:
    pile = [int((ranges_m >= largest_m - _SAME_M).sum()) for ranges_m in below]
    beside = sum(int((ranges_m >= largest_m - _BESIDE_M).sum()) for ranges_m in below) - sum(pile)
    total = sum(map(len, below))
    if not max(_PILE_MIN, beside) <= sum(pile) <= _PILE_SHARE_MAX * total:
        return False
    places = {
        (round(pose.x_m / _PLACE_M), round(pose.y_m / _PLACE_M))
        for pose, count in zip(poses, pile, strict=True)
        if count
    }
    # From several places: a robot that stands before one wall has a pile of equal ranges as well.
    return len(places) >= _PILE_PLACES or sum(pile) >= _PILE_SHARE * total
