"""Where the beams of a scan point whose line does not say so: by PARAM, by what was asked, or by their count."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_HALF_TURN_COUNTS = frozenset((180, 181, 360, 361, 400, 401, 720, 721))
"""Beams of a SICK LMS 200 or 291, in its steps of 1, 1/2 and 1/4 degree: half a turn."""
_KNOWN_FOV_DEG = {
    541: 270.0,
    682: 681 * 360 / 1024,
    683: 682 * 360 / 1024,
    726: 725 * 360 / 1024,
    769: 270.0,
    811: 270.0,
    1081: 270.0,
    1141: 190.0,
    1441: 270.0,
}
"""Beams of scanners that look farther round: SICK LMS 1xx and TiM, Hokuyo URG, UBG, UTM and UST."""
_LARGEST_RAD = math.tau + 0.01
_SMALLEST = 1e-4


@dataclass(frozen=True, slots=True)
class Bearings:
    """How the beams of a scan lie."""

    angles_rad: NDArray[np.float64]
    """Ascending and even, ``float64[n]``, the middle of them ahead."""
    assumed: str = ""
    """What was taken for granted, in words; empty where the log or the caller said it."""


def bearings_of(count: int, params: Mapping[str, str], scanner: str, fov_rad: float | None) -> Bearings:
    """Return the directions of ``count`` beams.

    Args:
        count: how many beams, at least two.
        params: the PARAM lines of the log.
        scanner: ``front`` or ``rear``.
        fov_rad: the field of view, if the caller knows it: it goes before everything else.
    """
    if fov_rad is None:
        fov_rad = _angle_rad(params, scanner, "fov", 1)
        step_rad = _angle_rad(params, scanner, "resolution", count - 1)
        if fov_rad is None and step_rad is not None:
            fov_rad = step_rad * (count - count % 2)
        # Both only where they agree: logs were written with a PARAM of another scanner left in them.
        if fov_rad is not None and step_rad is not None and _spans(step_rad, count, fov_rad):
            return Bearings(_from_right(count, fov_rad, step_rad))
    if fov_rad is not None:
        return Bearings(_from_right(count, fov_rad, _step_rad(count, fov_rad)))
    known_deg = _KNOWN_FOV_DEG.get(count)
    if known_deg is not None:
        words = f"{count} beams and no PARAM for them: taken for a scanner that sees {known_deg:.4g} deg"
        return Bearings(_from_right(count, math.radians(known_deg), math.radians(known_deg) / (count - 1)), words)
    words = "" if count in _HALF_TURN_COUNTS else f"{count} beams and no PARAM for them: taken to span 180 deg"
    return Bearings(_from_right(count, math.pi, _step_rad(count, math.pi)), words)


def _from_right(count: int, fov_rad: float, step_rad: float) -> NDArray[np.float64]:
    return step_rad * np.arange(count, dtype=np.float64) - fov_rad / 2


def _step_rad(count: int, fov_rad: float) -> float:
    """Return the step: an even number of beams leaves the last direction out, as 180 over 180 degrees do."""
    steps = count - count % 2 if fov_rad <= math.pi + 1e-6 or fov_rad >= math.tau - 1e-3 else count - 1
    return fov_rad / steps


def _spans(step_rad: float, count: int, fov_rad: float) -> bool:
    """Whether this many steps are the field of view, to a step."""
    return abs(step_rad * count - fov_rad) <= 1.1 * step_rad or abs(step_rad * (count - 1) - fov_rad) <= 0.1 * step_rad


def _angle_rad(params: Mapping[str, str], scanner: str, what: str, times: int) -> float | None:
    """Return an angle of a scanner; old logs have degrees, newer ones radians: none is as small as to be both.

    >>> params = {"laser_front_laser_fov": "4.712389", "laser_laser1_resolution": "0.25"}
    >>> [round(math.degrees(_angle_rad(params, "front", *asked)), 2) for asked in (("fov", 1), ("resolution", 1080))]
    [270.0, 0.25]
    """
    for name in names(scanner, what):
        try:
            angle = float(params.get(name, ""))
        except ValueError:
            continue
        if angle >= _SMALLEST and angle * times <= _LARGEST_RAD:
            return angle
        if angle >= _SMALLEST and math.radians(angle) * times <= _LARGEST_RAD:
            return math.radians(angle)
    return None


def names(scanner: str, what: str) -> tuple[str, ...]:
    """Return the names under which a scanner's setting is found, older and newer ones."""
    number = "1" if scanner == "front" else "2"
    return (
        f"laser_{scanner}_laser_{what}",
        f"{scanner}_laser_{what}",
        f"laser_{scanner}laser_{what}",
        f"robot_{scanner}_laser_{what}",
        f"robot_{scanner}laser_{what}",
        f"laser_laser{number}_{what}",
        f"laser{number}_{what}",
    )
