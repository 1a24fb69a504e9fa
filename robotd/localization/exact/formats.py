"""Maps of polygons as text: GeoJSON, WKT and TOML, with every decimal taken exactly as it is written.

TOML has ``outline_m`` for a room (all beyond is solid) and ``[[obstacle]]`` with ``points_m`` and ``holes_m``; the
simulation's worlds are read as well: the closed ``[[wall]]`` around the start is the room, the others are solid.
"""

import json
import re
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, Final, Protocol

from robotd.localization.exact.locate import contains
from robotd.localization.exact.planar import PlanarSet, area_within
from robotd.localization.exact.points import Point
from robotd.localization.exact.polygons import Polygon, Ring, ring_of, solid, turned
from robotd.localization.exact.rationals import DEFAULT, Arithmetic, rational

_WORDS = re.compile(r"[A-Za-z]+|[(),;=]|[^\s(),;=]+")


def map_of_geojson(text: str, arithmetic: Arithmetic = DEFAULT) -> PlanarSet:
    """Return the union of all polygons of a GeoJSON document, whatever features and collections they are in.

    Raises:
        ValueError: it is none, or has no polygons, or one has no area.
    """
    return _solid(_of_geometry(json.loads(text, parse_float=str), arithmetic))


def map_of_wkt(text: str, arithmetic: Arithmetic = DEFAULT) -> PlanarSet:
    """Return the union of all polygons of geometries in well-known text; other kinds are passed over.

    Raises:
        ValueError: there are none, or their parentheses do not match, or one has no area.
    """
    words = _WORDS.findall(text)
    found: list[Polygon] = []
    while words:
        kind = words.pop(0).upper()
        if kind in ("POLYGON", "MULTIPOLYGON") and words and words[0] == "(":
            nested = _nested(words)
            found.extend(_polygon(rings, arithmetic) for rings in ([nested] if kind == "POLYGON" else nested))
    return _solid(found)


def map_of_toml(text: str, arithmetic: Arithmetic = DEFAULT) -> PlanarSet:
    """Return what is solid in a map or in a simulated world in TOML.

    Raises:
        ValueError: it is neither, or a wall is open, or one has no area.
    """
    document = tomllib.loads(text, parse_float=str)
    if "wall" in document:
        return _of_world(document, arithmetic)
    found = [
        _polygon([item["points_m"], *item.get("holes_m", [])], arithmetic) for item in document.get("obstacle", [])
    ]
    return _solid(found, ring_of(document["outline_m"], arithmetic) if "outline_m" in document else None)


class Format(Protocol):
    """What reads a map."""

    def __call__(self, text: str, arithmetic: Arithmetic = DEFAULT) -> PlanarSet:
        """Return what is solid in it."""


FORMATS: Final[dict[str, Format]] = {
    ".toml": map_of_toml,
    ".geojson": map_of_geojson,
    ".json": map_of_geojson,
    ".wkt": map_of_wkt,
}
"""What reads a file, by its ending."""


def _solid(polygons: Iterable[Polygon], room: Ring | None = None) -> PlanarSet:
    found = list(polygons)
    if not found and room is None:
        raise ValueError("no polygons in it")
    return solid(found, room=room)


def _polygon(rings: Sequence[Sequence[Sequence[Any]]], arithmetic: Arithmetic) -> Polygon:
    if not rings:
        raise ValueError("a polygon has no ring")
    outer, *holes = (ring_of((corner[:2] for corner in ring), arithmetic) for ring in rings)
    return Polygon(outer, tuple(holes))


def _of_geometry(item: dict[str, Any], arithmetic: Arithmetic) -> Iterator[Polygon]:
    match item.get("type"):
        case "FeatureCollection":
            for feature in item["features"]:
                yield from _of_geometry(feature, arithmetic)
        case "Feature":
            yield from _of_geometry(item["geometry"] or {}, arithmetic)
        case "GeometryCollection":
            for geometry in item["geometries"]:
                yield from _of_geometry(geometry, arithmetic)
        case "Polygon":
            yield _polygon(item["coordinates"], arithmetic)
        case "MultiPolygon":
            yield from (_polygon(rings, arithmetic) for rings in item["coordinates"])


def _nested(words: list[str]) -> list[Any]:
    """Take one parenthesis off the front: of others, or of a list of corners."""
    inside: list[Any] = []
    corner: list[str] = []
    words.pop(0)
    while words:
        if words[0] == "(":
            inside.append(_nested(words))
            continue
        word = words.pop(0)
        if word in (",", ")"):
            if corner:
                inside.append(corner)
            corner = []
        else:
            corner.append(word)
        if word == ")":
            return inside
    raise ValueError("a parenthesis is not closed")


def _of_world(document: dict[str, Any], arithmetic: Arithmetic) -> PlanarSet:
    start = document["start"]
    at = Point(rational(start["x_m"], arithmetic), rational(start["y_m"], arithmetic))
    room: Ring | None = None
    obstacles: list[Polygon] = []
    for number, wall in enumerate(document["wall"], 1):
        if not wall.get("closed", True) or len(wall["points_m"]) < 3:
            raise ValueError(f"wall {number} encloses nothing: the exact algorithm takes areas")
        ring = ring_of(wall["points_m"], arithmetic)
        if room is None and _surrounds(ring, at):
            room = ring
        else:
            obstacles.append(Polygon(ring))
    return solid(obstacles, room=room)


def _surrounds(ring: Ring, point: Point) -> bool:
    return contains(area_within([turned(ring, counter_clockwise=True)], closed=True), point)
