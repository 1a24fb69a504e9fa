"""Map images: exact there and back, and a typed error for every damage."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.core.errors import MapError
from robotd.grid.image import cells_from_trinary, decode_pgm, encode_pgm, trinary_from_cells

pixels = hnp.arrays(np.uint8, hnp.array_shapes(min_dims=2, max_dims=2, max_side=6))


@given(pixels)
def test_a_picture_comes_back_exactly(grey: NDArray[np.uint8]) -> None:
    assert np.array_equal(decode_pgm(encode_pgm(grey)), grey)


def test_the_top_row_of_a_picture_is_the_one_of_largest_y() -> None:
    assert encode_pgm(np.array([[1, 2, 3], [4, 5, 6]], np.uint8)) == b"P5\n3 2\n255\n\x04\x05\x06\x01\x02\x03"


def test_comments_in_the_header_are_skipped() -> None:
    data = b"P5 # CREATOR: a map saver\n# another\n2 1\n255\n\x0a\x23"
    assert decode_pgm(data).tolist() == [[10, 35]]


@given(pixels, st.data())
def test_a_picture_cut_or_lengthened_anywhere_is_refused(grey: NDArray[np.uint8], data: st.DataObject) -> None:
    whole = encode_pgm(grey)
    cut = data.draw(st.integers(0, len(whole) - 1))
    for damaged in (whole[:cut], whole + b"\0"):
        with pytest.raises(MapError):
            decode_pgm(damaged)


@given(st.binary(max_size=60))
def test_garbage_is_refused_or_is_a_picture(garbage: bytes) -> None:
    for data in (garbage, b"P5\n" + garbage, b"P5 2 2 255\n" + garbage):
        try:
            decode_pgm(data)
        except MapError:
            continue


@pytest.mark.parametrize(
    ("data", "complaint"),
    [
        (b"P2\n1 1\n255\n0", "not a binary PGM"),
        (b"P5\n1 1\n65535\n\0\0", "white"),
        (b"P5\n0 4\n255\n", "absurd"),
        (b"P5\n99999 99999\n255\n\0", "absurd"),
        (b"P5\n-1 4\n255\n", "not a binary PGM"),
        (b"P5\n2 2\n255\n\0\0\0", "4|2 x 2"),
        (b"", "not a binary PGM"),
    ],
)
def test_damage_is_named(data: bytes, complaint: str) -> None:
    with pytest.raises(MapError, match=complaint):
        decode_pgm(data)


def test_cells_become_three_greys_by_map_servers_thresholds() -> None:
    cells = np.array([[0, 49, 50, 127, 128, 129, 165, 166, 255]], np.uint8)
    assert trinary_from_cells(cells).tolist() == [[254, 254, 205, 205, 205, 205, 205, 0, 0]]


def test_the_three_greys_load_as_what_they_were_saved_as() -> None:
    cells = np.arange(256, dtype=np.uint8)[None]
    grey = trinary_from_cells(cells)
    loaded = cells_from_trinary(grey)
    assert set(loaded.ravel().tolist()) == {0, 128, 255}
    assert np.array_equal(trinary_from_cells(loaded), grey)


def test_foreign_greys_load_by_the_rule_of_map_server() -> None:
    grey = np.array([[0, 89, 90, 204, 205, 206, 254, 255]], np.uint8)
    assert cells_from_trinary(grey).tolist() == [[255, 255, 128, 128, 128, 0, 0, 0]]
    assert cells_from_trinary(255 - grey, negate=True).tolist() == [[255, 255, 128, 128, 128, 0, 0, 0]]
    assert cells_from_trinary(grey, free_thresh=0.25).tolist() == [[255, 255, 128, 0, 0, 0, 0, 0]]
