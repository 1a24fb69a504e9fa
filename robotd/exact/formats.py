"""Maps of polygons as text: GeoJSON, WKT and TOML, with every decimal taken exactly as it is written.

TOML has ``outline_m`` for a room (all beyond is solid) and ``[[obstacle]]`` with ``points_m`` and ``holes_m``; the
simulation's worlds are read as well: the closed ``[[wall]]`` around the start is the room, the others are solid.
Points and lines have no inside: in GeoJSON and WKT they are passed over. A third coordinate is left out. Coordinates
are metres: degrees of longitude and latitude are refused where they are named, or plain to see.
"""

import json
import re
import tomllib
from collections import deque
from collections.abc import Iterable, Iterator
from typing import Any, Final, Protocol

from robotd.exact.degrees import Rings, refuse_degrees, refuse_geographic
from robotd.exact.locate import contains
from robotd.exact.planar import PlanarSet, area_within
from robotd.exact.points import Point
from robotd.exact.polygons import Polygon, Ring, ring_of, solid, turned
from robotd.exact.rationals import DEFAULT, Arithmetic, rational

_REFERENCE = re.compile(r"SRID=(\d+);", re.IGNORECASE)
"""In which coordinates a geometry is, as some databases write before it."""
_WORDS = re.compile(r"[A-Za-z]+|[(),;=]|[^\s(),;=]+")
_WITHOUT_INSIDE = {"Point", "MultiPoint", "LineString", "MultiLineString"}
_WKT_KINDS = {"POLYGON", "MULTIPOLYGON", "GEOMETRYCOLLECTION", *(kind.upper() for kind in _WITHOUT_INSIDE)}
_SHOWN = 60
"""Characters of a wrong value that an error message repeats."""
_DIMENSIONS = {"Z", "M", "ZM"}


def map_of_geojson(text: str, arithmetic: Arithmetic = DEFAULT) -> PlanarSet:
    """Return the union of all polygons of a GeoJSON document, whatever features and collections they are in.

    Raises:
        ValueError: it is none, or has no polygons, or one is impossible, or its coordinates are degrees; says which.
    """
    # Decimals stay text: as floats they would no longer be what was written.
    document = json.loads(text, parse_float=str)
    _expect(isinstance(document, dict), "an object of GeoJSON", "it", document)
    refuse_geographic(_crs_of(document))
    written = list(_of_geometry(document, "it"))
    refuse_degrees(written)
    return _solid(written, arithmetic)


def map_of_wkt(text: str, arithmetic: Arithmetic = DEFAULT) -> PlanarSet:
    """Return the union of all polygons of geometries in well-known text, one after another or in collections.

    Raises:
        ValueError: there are none, or something is no such text, or a polygon is impossible, or its coordinates are
            degrees; says which.
    """
    for number in _REFERENCE.findall(text):
        refuse_geographic(f"EPSG:{number}")
    words = deque(_WORDS.findall(_REFERENCE.sub("", text)))
    written = list(_of_wkt(words))
    if words:
        raise ValueError("a parenthesis is not opened")
    refuse_degrees(written)
    return _solid(written, arithmetic)


def map_of_toml(text: str, arithmetic: Arithmetic = DEFAULT) -> PlanarSet:
    """Return what is solid in a map or in a simulated world in TOML.

    Raises:
        ValueError: it is neither, or a key is unknown, or a wall is open, or a polygon is impossible; says which.
    """
    document = tomllib.loads(text, parse_float=str)
    if "wall" in document:
        return _of_world(document, arithmetic)
    _refuse_unknown(document, {"name", "outline_m", "obstacle"})
    obstacles = document.get("obstacle", [])
    # A misspelt key would leave something solid out of the map in silence.
    for obstacle in obstacles:
        _refuse_unknown(obstacle, {"name", "points_m", "holes_m"})
    room = ring_of(document["outline_m"], arithmetic) if "outline_m" in document else None
    return _solid(([item["points_m"], *item.get("holes_m", [])] for item in obstacles), arithmetic, room)


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


def _solid(written: Iterable[Rings], arithmetic: Arithmetic, room: Ring | None = None) -> PlanarSet:
    found = [_polygon(rings, number, arithmetic) for number, rings in enumerate(written, 1)]
    if not found and room is None:
        raise ValueError("no polygons in it")
    return solid(found, room=room)


def _polygon(rings: Rings, number: int, arithmetic: Arithmetic) -> Polygon:
    if not rings:
        raise ValueError(f"polygon {number}: no ring")
    try:
        outer, *holes = (ring_of((corner[:2] for corner in ring), arithmetic) for ring in rings)
        return Polygon(outer, tuple(holes))
    except ValueError as error:
        raise ValueError(f"polygon {number}: {error}") from error


def _refuse_unknown(table: dict[str, Any], known: set[str]) -> None:
    for key in table:
        if key not in known:
            raise ValueError(f"unknown key {key}; known: {', '.join(sorted(known))}")


def _crs_of(document: dict[str, Any]) -> str:
    """Return the name of the coordinate reference system that an older GeoJSON names; empty if there is none."""
    crs = document.get("crs")
    properties = crs.get("properties") if isinstance(crs, dict) else None
    return str(properties.get("name", "")) if isinstance(properties, dict) else ""


def _of_geometry(item: Any, where: str) -> Iterator[Rings]:
    """Yield the rings of all polygons in an object of GeoJSON; ValueError that says where it is not built as one."""
    _expect(isinstance(item, dict), "an object", where, item)
    match item.get("type"):
        case "FeatureCollection":
            yield from _of_all(item, "features", where)
        case "Feature":
            if item.get("geometry") is not None:
                yield from _of_geometry(item["geometry"], f"{where}, geometry")
        case "GeometryCollection":
            yield from _of_all(item, "geometries", where)
        case "Polygon":
            yield _checked_rings(item.get("coordinates"), f"{where}, coordinates")
        case "MultiPolygon":
            for number, rings in enumerate(_list_of(item, "coordinates", where), 1):
                yield _checked_rings(rings, f"{where}, coordinates, polygon {number}")
        case kind if str(kind) not in _WITHOUT_INSIDE:
            raise ValueError(f"{where}: {_short(kind)} is no type of GeoJSON")


def _of_all(item: dict[str, Any], key: str, where: str) -> Iterator[Rings]:
    for number, one in enumerate(_list_of(item, key, where), 1):
        yield from _of_geometry(one, f"{where}, {key} {number}")


def _list_of(item: dict[str, Any], key: str, where: str) -> list[Any]:
    found = item.get(key)
    _expect(isinstance(found, list), f"a list of {key}", where, found)
    return list(found or ())


def _checked_rings(rings: Any, where: str) -> Rings:
    """Return the rings of a polygon; ValueError if they are no lists of corners."""
    _expect(isinstance(rings, list), "a list of rings", where, rings)
    for ring in rings:
        _expect(isinstance(ring, list), "a ring, which is a list of corners", where, ring)
        for corner in ring:
            is_text = isinstance(corner, str)  # which is refused as a corner, with the number of its polygon
            is_pair = isinstance(corner, list) and all(isinstance(number, int | str) for number in corner)
            _expect(is_text or is_pair, "a corner, which has x and y", where, corner)
    return list(rings)


def _expect(is_so: bool, what: str, where: str, found: Any) -> None:
    if not is_so:
        raise ValueError(f"{where} is not built as such a file is: expected {what}, got {_short(found)}")


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."


def _of_wkt(words: deque[str]) -> Iterator[Rings]:
    """Take geometry after geometry off the front, up to the parenthesis that closes their collection."""
    while words and words[0] != ")":
        word = words.popleft()
        kind = word.upper()
        if kind == ",":
            continue
        if kind not in _WKT_KINDS:
            raise ValueError(f"{word} is no geometry of well-known text")
        if words and words[0].upper() in _DIMENSIONS:
            words.popleft()
        if words and words[0].upper() == "EMPTY":
            words.popleft()
        elif kind == "GEOMETRYCOLLECTION":
            _take("(", words)
            yield from _of_wkt(words)
            _take(")", words)
        else:
            nested = _nested(words)
            yield from {"POLYGON": [nested], "MULTIPOLYGON": nested}.get(kind, [])


def _nested(words: deque[str]) -> list[Any]:
    """Take one parenthesis off the front: of others, or of a list of corners."""
    inside: list[Any] = []
    corner: list[str] = []
    _take("(", words)
    while words:
        if words[0] == "(":
            inside.append(_nested(words))
            continue
        word = words.popleft()
        if word in (",", ")"):
            if corner:
                inside.append(corner)
            corner = []
        else:
            corner.append(word)
        if word == ")":
            return inside
    raise ValueError("a parenthesis is not closed")


def _take(parenthesis: str, words: deque[str]) -> None:
    if not words or words.popleft() != parenthesis:
        raise ValueError(f"a parenthesis is not {'opened' if parenthesis == '(' else 'closed'}")


def _of_world(document: dict[str, Any], arithmetic: Arithmetic) -> PlanarSet:
    _refuse_unknown(document, {"name", "start", "wall", "stops_m", "probes_m"})
    start = document["start"]
    at = Point(rational(start["x_m"], arithmetic), rational(start["y_m"], arithmetic))
    room: Ring | None = None
    obstacles: list[Polygon] = []
    for number, wall in enumerate(document["wall"], 1):
        _refuse_unknown(wall, {"name", "points_m", "closed", "height_m"})
        if not wall.get("closed", True) or len(wall["points_m"]) < 3:
            raise ValueError(f"wall {number} encloses nothing: the exact algorithm takes areas")
        ring = ring_of(wall["points_m"], arithmetic)
        if room is None and _surrounds(ring, at):
            room = ring
        else:
            obstacles.append(_polygon([wall["points_m"]], number, arithmetic))
    return solid(obstacles, room=room)


def _surrounds(ring: Ring, point: Point) -> bool:
    return contains(area_within([turned(ring, counter_clockwise=True)], closed=True), point)
