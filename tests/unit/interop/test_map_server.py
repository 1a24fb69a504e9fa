"""Maps of map_server: thresholds to the last bit, every value and placement there and back, and no trust in a file."""

import io
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from PIL import Image

from robotd.core.errors import MapError
from robotd.core.grid_spec import GridSpec
from robotd.grid.image import encode_pgm
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION
from robotd.grid.turning import turned
from robotd.interop.map_server import export_map, import_map
from robotd.interop.map_server_yaml import decode_map_yaml

WORDS: dict[str, Any] = {
    "image": "map.pgm",
    "resolution": 0.05,
    "origin": [-1.0, 2.0, 0.0],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}
ALL = np.arange(256, dtype=np.uint8).reshape(16, 16)
finite = st.floats(-1e6, 1e6)
grids = st.builds(
    lambda spec, seed: OccupancyGrid(spec, np.random.default_rng(seed).integers(0, 256, spec.shape, np.uint8)),
    st.builds(GridSpec, st.floats(0.005, 2.0), finite, finite, st.tuples(st.integers(1, 9), st.integers(1, 9))),
    st.integers(0, 2**32 - 1),
)


def described(**changes: Any) -> Any:
    return decode_map_yaml(yaml.safe_dump({**WORDS, **changes}).encode())


def imported(picture: bytes, **changes: Any) -> NDArray[np.uint8]:
    return import_map(described(**changes), picture).grid.cells


def again(files: dict[str, bytes]) -> OccupancyGrid:
    [text] = [content for name, content in files.items() if name.endswith(".yaml")]
    told = decode_map_yaml(text)
    return import_map(told, files[told.image]).grid


def map_server_says(grey: int, *, negate: bool, occupied: float, free: float) -> int:
    """Be map_server, trinary: 100, 0 or -1, by a quotient in double precision."""
    probability = grey / 255 if negate else (255 - grey) / 255
    return 100 if probability >= occupied else 0 if probability <= free else -1


@given(occupied=st.floats(0.0, 1.0), free=st.floats(0.0, 1.0), negate=st.booleans())
def test_every_grey_is_what_map_server_takes_it_for(occupied: float, free: float, negate: bool) -> None:
    if free >= occupied:
        free, occupied = occupied, free
    if free == occupied:
        return
    cells = imported(bytes(encode_pgm(ALL)), negate=int(negate), occupied_thresh=occupied, free_thresh=free).ravel()
    for grey, value in enumerate(cells.tolist()):
        said = map_server_says(grey, negate=negate, occupied=occupied, free=free)
        assert (value > NO_INFORMATION) - (value < NO_INFORMATION) == {100: 1, 0: -1, -1: 0}[said]


@given(grid=grids)
@settings(deadline=None)
def test_scale_keeps_every_value_and_the_placement_to_the_last_bit(grid: OccupancyGrid) -> None:
    back = again(export_map(grid, "map", "scale"))
    assert back.spec == grid.spec
    np.testing.assert_array_equal(back.cells, grid.cells)


@given(grid=grids, mode=st.sampled_from(["trinary", "raw"]))
@settings(deadline=None)
def test_what_others_read_holds_walls_and_free_cells_where_they_are(grid: OccupancyGrid, mode: str) -> None:
    back = again(export_map(grid, "map", mode))
    assert back.spec == grid.spec
    sure = (grid.cells >= 166) | (grid.cells <= 49) | (grid.cells == NO_INFORMATION)
    kinds = [np.sign(one.cells.astype(int) - NO_INFORMATION)[sure] for one in (back, grid)]
    np.testing.assert_array_equal(*kinds)
    if mode == "raw":
        assert np.abs(back.cells.astype(int) - grid.cells).max() <= 2


@pytest.mark.parametrize("mode", ["trinary", "scale", "raw"])
def test_other_programs_read_what_is_exported(mode: str) -> None:
    grid = OccupancyGrid(GridSpec(0.05, 1e-7, -2.0, (16, 16)), ALL)
    files = export_map(grid, "hall", mode)
    told = yaml.safe_load(files["hall.yaml"])
    assert (told["mode"], told["resolution"], told["origin"]) == (mode, 0.05, [1e-7, -2.0, 0])
    with Image.open(io.BytesIO(files[told["image"]])) as picture:
        assert picture.size == (16, 16)
        assert picture.getbands()[0] in {"L", "R"}


def encoded(picture: Image.Image, kind: str) -> bytes:
    found = io.BytesIO()
    picture.save(found, kind)
    return found.getvalue()


GREY = Image.fromarray(ALL)
DEEP = b"P5 16 16 65535\n" + (ALL.astype(np.uint16) * 257).astype(">u2").tobytes()
PLAIN = b"P2\n# made by hand\n16 16\n# and a comment\n255\n" + " ".join(map(str, ALL.ravel().tolist())).encode()


@pytest.mark.parametrize(
    "picture",
    [
        encoded(GREY, "PPM"),
        encoded(GREY, "PNG"),
        encoded(GREY, "BMP"),
        encoded(GREY.convert("RGB"), "PNG"),
        encoded(GREY.convert("RGB").quantize(256), "PNG"),
        encoded(GREY.convert("LA"), "PNG"),
        encoded(GREY.convert("RGBA"), "PNG"),
        encoded(Image.fromarray(ALL.astype(np.uint16) * 257), "PNG"),
        DEEP,
        PLAIN,
        b"P5\n# one\n# two\n16 16\n255\n" + ALL.tobytes(),
    ],
    ids=["pgm", "png", "bmp", "rgb", "palette", "la", "rgba", "16 bit png", "16 bit pgm", "P2", "comments"],
)
def test_a_picture_of_any_depth_is_the_same_map(picture: bytes) -> None:
    np.testing.assert_array_equal(imported(picture, mode="scale"), 255 - ALL[::-1])


def test_what_can_be_seen_through_is_unknown() -> None:
    picture = Image.fromarray(np.zeros((1, 3), np.uint8)).convert("LA")
    picture.putalpha(Image.fromarray(np.array([[255, 254, 0]], np.uint8)))
    for mode in ("trinary", "scale"):
        assert imported(encoded(picture, "PNG"), mode=mode).tolist() == [[255, NO_INFORMATION, NO_INFORMATION]]


def test_raw_pixels_are_per_cent() -> None:
    picture = encode_pgm(np.array([[0, 1, 50, 99, 100, 101, 255]], np.uint8))
    assert imported(bytes(picture), mode="raw").tolist() == [[0, 3, 128, 252, 255, 128, 128]]


def test_the_grey_of_unknown_that_loads_as_free_is_said() -> None:
    picture = bytes(encode_pgm(np.array([[0, 205, 254, 205]], np.uint8)))
    found = import_map(described(free_thresh=0.25), picture)
    [note] = found.notes
    assert note.startswith("50% of its pixels are 205, which most programs write for unknown; with free_thresh 0.25")
    assert (found.grid.cells < NO_INFORMATION).sum() == 3
    assert import_map(described(), picture).notes == ()


def test_a_map_that_nobody_can_be_found_on_says_so() -> None:
    blank = bytes(encode_pgm(np.full((2, 2), 205, np.uint8)))
    assert import_map(described(), blank).notes == (
        "it has no walls: nobody can be localized on it",
        "it has no free cells: the robot can be nowhere on it",
    )


@given(rows=st.integers(1, 6), cols=st.integers(1, 6), quarters=st.integers(0, 4), seed=st.integers(0, 99))
def test_a_quarter_turn_loses_nothing(rows: int, cols: int, quarters: int, seed: int) -> None:
    cells = np.random.default_rng(seed).integers(0, 256, (rows, cols), np.uint8)
    spec = GridSpec(0.5, 3.0, -4.0, (rows, cols))
    found, there = turned(cells, spec, float(f"{quarters * math.pi / 2:.12f}"))
    # Rows run upwards here, and downwards for rot90.
    np.testing.assert_array_equal(found, np.rot90(cells, -quarters))
    for row in range(rows):
        for col in range(cols):
            x, y = (np.array(spec.centre_of(row, col)) - [3.0, -4.0]).tolist()
            cos, sin = math.cos(quarters * math.pi / 2), math.sin(quarters * math.pi / 2)
            assert found[there.cell_at(3.0 + cos * x - sin * y, -4.0 + sin * x + cos * y)] == cells[row, col]


@given(yaw_rad=st.floats(-4.0, 4.0), seed=st.integers(0, 99))
def test_a_turned_map_has_at_each_centre_what_lay_there(yaw_rad: float, seed: int) -> None:
    cells = np.random.default_rng(seed).integers(0, 256, (5, 7), np.uint8)
    spec = GridSpec(0.1, 0.3, 0.7, (5, 7))
    found, there = turned(cells, spec, yaw_rad)
    cos, sin = math.cos(-yaw_rad), math.sin(-yaw_rad)
    for row, col in np.ndindex(found.shape):
        x, y = there.centre_of(row, col)
        x, y = x - 0.3, y - 0.7
        back = spec.positions_at(np.array([[0.3 + cos * x - sin * y, 0.7 + sin * x + cos * y]]))[0]
        if np.abs(back - np.rint(back)).min() < 1e-6:
            continue  # on a border, where rounding chooses
        inside = spec.contains(*np.floor(back).astype(int).tolist())
        assert found[row, col] == (cells[tuple(np.floor(back).astype(int))] if inside else NO_INFORMATION)


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"image": "../secret.pgm"}, "image: expected a file name in the folder of the yaml, got ../secret.pgm"),
        ({"image": "/etc/shadow"}, "image: expected a file name in the folder of the yaml, got /etc/shadow"),
        ({"image": ""}, "image: expected a file name"),
        ({"resolution": "wide"}, "resolution: expected metres per pixel, a number, got wide"),
        ({"resolution": 50}, "resolution: expected metres per pixel from 0.001 to 10, got 50"),
        ({"resolution": float("nan")}, "resolution: expected metres per pixel, a number, got nan"),
        ({"origin": [0.0, 1.0]}, "origin: expected three numbers: x, y [m] and yaw [rad], got [0.0, 1.0]"),
        ({"origin": "here"}, "origin: expected three numbers"),
        ({"free_thresh": 0.7}, "expected 0 <= free_thresh < occupied_thresh <= 1, got 0.7 and 0.65"),
        ({"negate": 2}, "negate: expected 0 or 1, got 2"),
        ({"mode": "colour"}, "mode: expected one of trinary, scale, raw, got colour"),
    ],
)
def test_a_key_that_cannot_be_is_named_with_what_was_expected(changes: dict[str, Any], complaint: str) -> None:
    with pytest.raises(MapError) as caught:
        described(**changes)
    assert complaint in str(caught.value)


@pytest.mark.parametrize("missing", WORDS)
def test_a_missing_key_is_named(missing: str) -> None:
    with pytest.raises(MapError, match=f"{missing} is missing; expected"):
        decode_map_yaml(yaml.safe_dump({key: value for key, value in WORDS.items() if key != missing}).encode())


@pytest.mark.parametrize(
    "text", [b"", b"- 1", b"image: [", b"\xff\xfe\x00", b"!!python/object:os.system x", b"[" * 9999]
)
def test_what_is_no_yaml_of_a_map_is_said(text: bytes) -> None:
    with pytest.raises(MapError, match=r"it is no yaml|expected keys and values"):
        decode_map_yaml(text)


def test_numbers_as_other_programs_write_them_are_numbers() -> None:
    told = decode_map_yaml(yaml.safe_dump({**WORDS, "origin": ["1e-7", 0, 0]}).encode())
    assert told.origin_x_m == 1e-7


HEADERS = [
    b"P5 0 0 255\n",
    b"P5 -1 4 255\n",
    b"P5 99999 99999 255\n",
    b"P5 4 4 0\n",
    b"P5 4 4 99999\n",
    b"P5 4 4 255\n\0\0",
    b"P2 2 2 255\n1 2 3",
    b"P2 2 2 255\n1 2 3 x",
    b"P6 1 1 255\n",
    b"GIF89a\1\0\1\0\0\0\0;",
    b"\x89PNG\r\n\x1a\n",
    b"BM",
    b"",
]


@pytest.mark.parametrize("picture", HEADERS)
def test_a_hostile_header_is_refused_in_words(picture: bytes) -> None:
    with pytest.raises(MapError, match=r"picture|pixels"):
        imported(picture)


@given(data=st.data())
@settings(max_examples=300, deadline=None)
def test_damaged_pictures_are_refused_or_read_never_more(data: st.DataObject) -> None:
    whole = bytearray(data.draw(st.sampled_from([encoded(GREY, "PNG"), encoded(GREY, "BMP"), PLAIN, DEEP])))
    for _ in range(data.draw(st.integers(1, 4))):
        whole[data.draw(st.integers(0, len(whole) - 1))] = data.draw(st.integers(0, 255))
    cut = data.draw(st.integers(0, len(whole)))
    try:
        found = imported(bytes(whole[:cut]))
    except MapError:
        return
    assert found.dtype == np.uint8


@pytest.mark.real_data
@pytest.mark.parametrize(
    ("name", "size", "walls", "notes"),
    [
        ("skirk", (602, 431), 0.74, ("74% of it are walls",)),
        ("stata_basement", (1300, 1730), 0.86, ("86% of it are walls",)),
        ("willow-2010-02-18-0.10", (608, 566), 0.02, ()),
    ],
)
def test_maps_of_real_buildings_are_what_their_makers_drew(
    laser_data: Path, name: str, size: tuple[int, int], walls: float, notes: tuple[str, ...]
) -> None:
    folder = laser_data / "maps-real-buildings"
    told = decode_map_yaml((folder / f"{name}.yaml").read_bytes())
    found = import_map(told, (folder / told.image).read_bytes())
    assert found.grid.spec.shape == size
    assert (found.grid.cells > NO_INFORMATION).mean() == pytest.approx(walls, abs=0.02)
    assert (found.grid.cells < NO_INFORMATION).mean() > 0.1
    assert len(found.notes) == len(notes)
    assert all(said.startswith(wanted) for said, wanted in zip(found.notes, notes, strict=True))
