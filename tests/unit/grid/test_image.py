"""Map images: every pixel in its place, and map_server's three greys."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from robotd.grid.image import encode_pgm, trinary_from_cells

pixels = hnp.arrays(np.uint8, hnp.array_shapes(min_dims=2, max_dims=2, max_side=6))


@given(pixels, st.data())
def test_every_pixel_stands_where_a_reader_looks_for_it(grey: NDArray[np.uint8], data: st.DataObject) -> None:
    magic, size, white, body = bytes(encode_pgm(grey)).split(b"\n", 3)
    rows, cols = grey.shape
    assert (magic, size, white, len(body)) == (b"P5", b"%d %d" % (cols, rows), b"255", rows * cols)
    row, col = data.draw(st.integers(0, rows - 1)), data.draw(st.integers(0, cols - 1))
    assert body[(rows - 1 - row) * cols + col] == grey[row, col]


def test_the_top_row_of_a_picture_is_the_one_of_largest_y() -> None:
    assert bytes(encode_pgm(np.array([[1, 2, 3], [4, 5, 6]], np.uint8))) == b"P5\n3 2\n255\n\x04\x05\x06\x01\x02\x03"


def test_cells_become_three_greys_by_map_servers_thresholds() -> None:
    cells = np.array([[0, 49, 50, 127, 128, 129, 165, 166, 255]], np.uint8)
    assert trinary_from_cells(cells).tolist() == [[254, 254, 205, 205, 205, 205, 205, 0, 0]]
