"""Whether coordinates are degrees on the globe: GeoJSON's are unless it says otherwise, and a robot needs metres."""

import re
from collections.abc import Iterable, Sequence
from typing import Any

Rings = Sequence[Sequence[Sequence[Any]]]
"""The rings of a polygon as they are written, its outer one first."""

_GEOGRAPHIC_NAMES = re.compile(r"CRS:?(?:84|83|27)\b", re.IGNORECASE)
_EPSG = re.compile(r"EPSG.*?(\d+)$", re.IGNORECASE)
_GEOGRAPHIC_EPSG = frozenset(
    {4171, 4202, 4203, 4230, 4258, 4267, 4269, 4277, 4283, 4326, 4490, 4612, 4617, 4674, 4979, 6318, 6668, 7844}
)
"""Of the registry's some hundred geographic systems those that maps of buildings come in."""
_LONGITUDE_MAX, _LATITUDE_MAX = 180.0, 90.0
_EXTENT_MIN = 0.5
"""A map in metres has more extent than this, and a building in degrees, or a town, much less."""
_ADVICE = "the exact algorithm needs metres: project them first, to UTM for one, or write metres as TOML (points_m)"


def refuse_geographic(name: str) -> None:
    """Raise ValueError if a coordinate reference system counts in degrees.

    Args:
        name: as written: ``urn:ogc:def:crs:OGC:1.3:CRS84``, ``EPSG:4326``; of an unknown one nothing is said.
    """
    number = _EPSG.search(name)
    if _GEOGRAPHIC_NAMES.search(name) or (number and int(number[1]) in _GEOGRAPHIC_EPSG):
        raise ValueError(f"its coordinates are longitude and latitude ({name}): {_ADVICE}")


def refuse_degrees(polygons: Iterable[Rings]) -> None:
    """Raise ValueError if all corners lie on the globe, and so near together that they cannot be a map in metres."""
    corners = [pair for rings in polygons for ring in rings for pair in _pairs(ring)]
    if not corners:
        return
    xs, ys = zip(*corners, strict=True)
    width, height = max(xs) - min(xs), max(ys) - min(ys)
    is_on_globe = max(map(abs, xs)) <= _LONGITUDE_MAX and max(map(abs, ys)) <= _LATITUDE_MAX
    if is_on_globe and max(width, height) < _EXTENT_MIN:
        size = f"{width:.3g} x {height:.3g} m"
        raise ValueError(
            f"its coordinates look like longitude and latitude, for in metres it would be {size}: {_ADVICE}"
        )


def _pairs(ring: Sequence[Sequence[Any]]) -> list[tuple[float, float]]:
    """Return the corners that are numbers; what is none is refused where polygons are made."""
    pairs = []
    for corner in ring:
        try:
            pairs.append((float(corner[0]), float(corner[1])))
        except (IndexError, KeyError, OverflowError, TypeError, ValueError):
            continue
    return pairs
