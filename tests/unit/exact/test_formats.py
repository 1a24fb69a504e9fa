"""One map in all formats is one map; what is no map is refused with a reason."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.exact.formats import map_of_geojson, map_of_toml, map_of_wkt
from robotd.exact.locate import contains
from robotd.exact.measure import face_areas
from robotd.exact.outlines import outlines
from robotd.exact.points import Point
from robotd.exact.polygons import edge_count
from robotd.exact.rationals import rational
from robotd.exact.readings_table import beams_of
from robotd.exact.surds import sqrt
from robotd.exact.sweep import arrange
from robotd.sim.buildings.world import WORLDS_DIR, load_world, world_names

GEOJSON = """{"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {}, "geometry":
{"type": "MultiPolygon", "coordinates": [[[[0,0],[3,0],[3,3],[0,3],[0,0]],[[1,1],[1,2.1],[2,2.1],[2,1],[1,1]]],
[[[5,0],[6,0],[5.5,0.7],[5,0]]]]}}]}"""
WKT = """POLYGON ((0 0, 3 0, 3 3, 0 3, 0 0), (1 1, 2 1, 2 2.1, 1 2.1, 1 1))
MULTIPOLYGON (((5 0, 6 0, 5.5 7e-1, 5 0)))"""
TOML = """[[obstacle]]
points_m = [[0, 0], [3, 0], [3, 3], [0, 3]]
holes_m = [[[1, 1], [2, 1], [2, 2.1], [1, 2.1]]]
[[obstacle]]
points_m = [[5, 0], [6, 0], [5.5, 0.7]]"""


WKT_OF_MORE = """SRID=25832;GEOMETRYCOLLECTION (POINT (1 2), LINESTRING EMPTY,
POLYGON Z ((0 0 9, 3 0 9, 3 3 9, 0 3 9, 0 0 9), (1 1 9, 2 1 9, 2 2.1 9, 1 2.1 9, 1 1 9)),
POLYGON EMPTY, MULTIPOLYGON ZM (((5 0 1 2, 6 0 1 2, 5.5 0.7 1 2))))"""
GEOJSON_OF_MORE = """{"type": "GeometryCollection", "geometries": [{"type": "Point", "coordinates": [1, 2]},
{"type": "Polygon", "coordinates": [[[0,0,9],[3,0,9],[3,3,9],[0,3,9],[0,0,9]],[[1,1],[1,2.1],[2,2.1],[2,1],[1,1]]]},
{"type": "Feature", "geometry": null}, {"type": "Polygon", "coordinates": [[[5,0],[6,0],[5.5,0.7],[5,0]]]}]}"""


@pytest.mark.parametrize(
    ("read", "text"),
    [
        (map_of_geojson, GEOJSON),
        (map_of_geojson, GEOJSON_OF_MORE),
        (map_of_wkt, WKT),
        (map_of_wkt, WKT_OF_MORE),
        (map_of_toml, TOML),
    ],
)
def test_a_map_is_the_same_in_every_format(read, text: str) -> None:  # type: ignore[no-untyped-def]  # three readers
    obstacles = read(text)
    assert edge_count(obstacles) == 11
    for x, y, expected in [
        ("1.5", "2.1", True),
        ("1.5", "2.09", False),
        ("5.5", "0.7", True),
        ("5.5", "0.7001", False),
    ]:
        assert contains(obstacles, Point(rational(x), rational(y))) == expected


@pytest.mark.parametrize(
    ("read", "text", "message"),
    [
        (map_of_geojson, '{"type": "Point", "coordinates": [1, 2]}', "no polygons"),
        (map_of_wkt, "POLYGON ((0 0, 1 0, 1 1", "not closed"),
        (map_of_wkt, "POLYGON ((0 0, 1 0, 2 0))", "polygon 1: a ring needs an area, and one of 3 corners has none"),
        (map_of_wkt, "POLYGON ((0 0, 1 0, 1 1)) POLYGON ((0 0, 1 0, 2 0))", "polygon 2: a ring needs an area"),
        (map_of_wkt, "POLYGON ((0 0, 1 0, 1 one))", "polygon 1: must be a finite number below 1e90, got 'one'"),
        (map_of_wkt, "POLYGON ((0 0, 1 0, 1 1)) CURVEPOLYGON ((0 0, 1 0, 1 1))", "CURVEPOLYGON is no geometry"),
        (map_of_wkt, "POLYGON (0 0, 1 0, 1 1)", "polygon 1: a corner needs x and y, got 0"),
        (map_of_wkt, "POLYGON ((0 0, 1 0, 1 1) 7", "not closed"),
        (map_of_wkt, "POLYGON ((0 0, 1 0, 1 1)))", "a parenthesis is not opened"),
        (map_of_wkt, "POLYGON ((0 0, 4 4, 4 0, 0 3))", "a ring crosses or overlaps itself"),
        (map_of_geojson, '{"type": "Polygon", "coordinates": []}', "no ring"),
        (map_of_geojson, '{"type": "Polygon", "coordinates": [[[0], [1, 0], [1, 1]]]}', "needs x and y"),
        (map_of_geojson, '{"type": "Polygon", "coordinates": [["00", "10", "11"]]}', "needs x and y, got 00"),
        (map_of_geojson, '{"type": "polygon", "coordinates": []}', "'polygon' is no type of GeoJSON"),
        (map_of_toml, "name = 'nothing'", "no polygons"),
        (map_of_toml, "outline_m = [[0, 0], [1e99, 0], [0, 1]]", "must be a finite number below 1e90, got '1e99'"),
        (map_of_toml, "outline_m = [[0, 0], [9, 0], [9, 9]]\n[[obstacles]]\n", "unknown key obstacles; known: "),
        (map_of_toml, TOML + "\nhole_m = []", "unknown key hole_m; known: "),
        (map_of_toml, "start = {x_m = 0, y_m = 0}\n[[wall]]\npoints_m = [[1, 1], [2, 2]]", "encloses nothing"),
    ],
)
def test_what_is_no_map_is_refused(read, text: str, message: str) -> None:  # type: ignore[no-untyped-def]  # the same
    with pytest.raises(ValueError, match=message):
        read(text)


def test_a_simulated_world_is_a_room_with_obstacles() -> None:
    world = Path(__file__).parents[3] / "robotd/sim/buildings/worlds/laboratory.toml"
    obstacles = map_of_toml(world.read_text(encoding="utf-8"))
    assert not contains(obstacles, Point(rational("1.2"), rational("1.2")))
    assert contains(obstacles, Point(rational(-100), rational(3)))
    assert contains(obstacles, Point(rational("6.5"), rational(4)))


@pytest.mark.parametrize("name", world_names())
def test_every_simulated_world_is_a_map(name: str) -> None:
    start = load_world(name).start
    obstacles = map_of_toml((WORLDS_DIR / f"{name}.toml").read_text(encoding="utf-8"))
    assert obstacles.far
    assert not contains(obstacles, Point(rational(start.x_m), rational(start.y_m)))


@settings(max_examples=40, deadline=None)
@given(hnp.arrays(np.bool_, st.tuples(st.integers(1, 5), st.integers(1, 5))), st.booleans())
def test_outlines_surround_just_the_occupied_cells(occupied: NDArray[np.bool_], outside: bool) -> None:
    cell = rational("0.5")
    walls = outlines(occupied, cell, x=rational(-1), y=rational(2), outside=outside)
    for (row, col), is_occupied in np.ndenumerate(np.pad(occupied, 1, constant_values=outside)):
        centre = Point(cell * (2 * col - 1) / 2 - 1, cell * (2 * row - 1) / 2 + 2)
        assert contains(walls, centre) == is_occupied
    arrangement = arrange([walls])
    bounded = sum(area for area, mask in zip(face_areas(arrangement), arrangement.faces, strict=True) if mask ^ outside)
    assert bounded == pytest.approx(0.25 * (occupied ^ outside).sum())


def test_readings_are_read_exactly() -> None:
    east, miss = beams_of(["# two readings\n", "bearing_deg,range_m,status\n", "0,1.05,hit\n", "45,2,miss\n"])
    assert (east.dx, east.dy) == (rational("1.05"), rational(0))
    assert east.is_hit
    assert miss.length == 2
    assert not miss.is_hit
    (spaced,) = beams_of(["bearing_deg, range_m, status\n", "0, 2, miss\n"])
    assert spaced.dx == 2
    assert not spaced.is_hit
    assert float(miss.dx) == pytest.approx(float(sqrt(rational(2))), abs=2e-9)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (["bearing_deg\n", "0\n"], "no column range_m"),
        (["bearing_deg,range_m\n"], "no readings"),
        (["bearing_deg,range_m\n", "0,-1\n"], "must be positive"),
        (["bearing_deg,range_m,status\n", "0,1,fault\n"], "hit or miss"),
        (["bearing_deg,range_m\n", "0,1\n", "0\n"], "reading 2: another number of columns"),
        (["bearing_deg,range_m\n", "0,1,hit\n"], "reading 1: another number of columns"),
        (["bearing_deg,range_m\n", "nan,1\n"], "reading 1: must be a finite number below 1e90, got 'nan'"),
        (["bearing_deg,range_m\n", "0,far\n"], "reading 1: must be a finite number below 1e90, got 'far'"),
        (["bearing_deg,range_m\n", "0,1e999\n"], "reading 1: must be a finite number below 1e90, got '1e999'"),
        (
            ["bearing_deg,range_m\n", "0,1e-9999999999\n"],
            "reading 1: must be a finite number below 1e90, got '1e-9999999999'",
        ),
    ],
)
def test_impossible_readings_are_refused(lines: list[str], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        beams_of(lines)


CAMPUS = "[[[11.5676, 48.1488], [11.5690, 48.1488], [11.5690, 48.1496], [11.5676, 48.1496], [11.5676, 48.1488]]]"
IN_METRES = "[[[691234.1, 5335678.2], [691240.1, 5335678.2], [691240.1, 5335684.2], [691234.1, 5335678.2]]]"


def geojson(coordinates: str, crs: str | None = None) -> str:
    linked = "" if crs is None else f'"crs": {{"type": "name", "properties": {{"name": "{crs}"}}}}, '
    return f'{{{linked}"type": "Polygon", "coordinates": {coordinates}}}'


@pytest.mark.parametrize(
    ("read", "text"),
    [
        (map_of_geojson, geojson(CAMPUS)),
        (map_of_geojson, geojson(IN_METRES, "urn:ogc:def:crs:OGC:1.3:CRS84")),
        (map_of_geojson, geojson("[[[0, 0], [9, 0], [9, 9]]]", "EPSG:4326")),
        (map_of_geojson, geojson("[[[0, 0], [9, 0], [9, 9]]]", "urn:ogc:def:crs:EPSG::4258")),
        (map_of_wkt, "SRID=4326;POLYGON ((0 0, 9 0, 9 9))"),
        (map_of_wkt, "POLYGON ((-122.33 47.66, -122.32 47.66, -122.32 47.67, -122.33 47.66))"),
    ],
)
def test_longitude_and_latitude_are_no_metres(read, text: str) -> None:  # type: ignore[no-untyped-def]  # two readers
    with pytest.raises(ValueError, match=r"longitude and latitude.*needs metres"):
        read(text)


@pytest.mark.parametrize(
    ("read", "text"),
    [
        (map_of_geojson, geojson(IN_METRES, "urn:ogc:def:crs:EPSG::25832")),
        (map_of_geojson, geojson(IN_METRES).replace("{", '{"crs": null, ', 1)),
        (map_of_wkt, "POLYGON ((0 0, 0.6 0, 0.6 0.2))"),
        (map_of_wkt, "SRID=32632;POLYGON ((0 0, 0.6 0, 0.6 0.2))"),
        (map_of_toml, "outline_m = [[0, 0], [0.4, 0], [0.4, 0.3]]"),
    ],
)
def test_metres_are_metres(read, text: str) -> None:  # type: ignore[no-untyped-def]  # three readers
    assert edge_count(read(text)) == 3


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[]", "it is not built as such a file is: expected an object of GeoJSON"),
        ('{"type": "FeatureCollection"}', "it is not built as such a file is: expected a list of features, got None"),
        ('{"type": "FeatureCollection", "features": [7]}', "it, features 1 is not built .*: expected an object, got 7"),
        ('{"type": "Feature", "geometry": "x"}', "it, geometry is not built .*: expected an object, got 'x'"),
        (geojson("null"), "it, coordinates is not built .*: expected a list of rings, got None"),
        (geojson("[7]"), "expected a ring, which is a list of corners, got 7"),
        (geojson("[[7]]"), "expected a corner, which has x and y, got 7"),
        (geojson("[[[{}, 0], [1, 0], [1, 1]]]"), "expected a corner"),
        (geojson("[[[null, 0], [1, 0], [1, 1]]]"), "expected a corner"),
        ('{"type": "MultiPolygon", "coordinates": [[[[0,0],[1,0],[1,1]]], {}]}', "coordinates, polygon 2 is not built"),
        ('{"type": ["Polygon"], "coordinates": []}', r"\['Polygon'\] is no type of GeoJSON"),
    ],
)
def test_what_is_not_built_as_geojson_is_named_with_its_place(text: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        map_of_geojson(text)
