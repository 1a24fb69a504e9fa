"""The bytes of a grid are the same for ever: digests, the wire, recordings and stored maps all hold them."""

import base64
import tracemalloc
import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from robotd.core.grid_bytes import cell_bytes, cells_of, grid_digest, packed_cells, unpacked_cells
from robotd.core.grid_spec import MAX_SIDE_CELLS, GridSpec

SPEC = GridSpec(0.05, -1 / 3, 2.5, (3, 4))
CELLS = np.arange(0, 240, 20, dtype=np.uint8).reshape(3, 4)
ON_THE_WIRE = bytes.fromhex("78016310d1b00948a9e859b0e5c41d0016640529")
IN_OLD_RECORDINGS = base64.b64decode("eJxjENGwCUip6Fmw5cQdABZkBSk=")


def test_what_version_0_1_wrote_is_read_and_written_again() -> None:
    assert grid_digest(SPEC, CELLS) == "1d7aaa29283137dcaf5daac1a316706788cb3f274352c63ff45cea3e8d98cc0f"
    assert bytes(cell_bytes(CELLS)) == bytes(range(0, 240, 20))
    assert zlib.decompress(packed_cells(CELLS)) == bytes(range(0, 240, 20))
    for packed in (ON_THE_WIRE, IN_OLD_RECORDINGS):
        np.testing.assert_array_equal(unpacked_cells(packed, SPEC), CELLS)


@given(shape=st.tuples(st.integers(1, 9), st.integers(1, 9)), data=st.data())
def test_cells_come_back_whatever_order_they_lie_in(shape: tuple[int, int], data: st.DataObject) -> None:
    spec = GridSpec(1.0, 0.0, 0.0, shape)
    cells = np.asfortranarray(data.draw(arrays(np.uint8, shape)))
    np.testing.assert_array_equal(cells_of(cell_bytes(cells), spec), cells)
    np.testing.assert_array_equal(unpacked_cells(packed_cells(cells), spec), cells)


def test_the_bytes_are_no_copy() -> None:
    assert np.shares_memory(np.frombuffer(cell_bytes(CELLS), np.uint8), CELLS)


@pytest.mark.parametrize(
    ("packed", "says"),
    [
        (b"", "expected 12 bytes of cells for 3 x 4, got 0"),
        (b"no zlib", "cannot be unpacked"),
        (ON_THE_WIRE[:-1], "got 12"),
        (ON_THE_WIRE[:-6], "expected 12 bytes"),
        (ON_THE_WIRE[:8] + b"\xff" + ON_THE_WIRE[9:], "cannot be unpacked|expected 12"),
        (ON_THE_WIRE + b"x", "got more"),
        (zlib.compress(bytes(11)), "got 11"),
        (zlib.compress(bytes(13)), "got more"),
    ],
)
def test_what_is_not_this_grid_is_refused(packed: bytes, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        unpacked_cells(packed, SPEC)


def test_a_bomb_takes_no_more_memory_than_the_grid() -> None:
    bomb = zlib.compress(bytes(1 << 26), 9)
    tracemalloc.start()
    try:
        with pytest.raises(ValueError, match="got more"):
            unpacked_cells(bomb, SPEC)
        assert tracemalloc.get_traced_memory()[1] < 1 << 20
    finally:
        tracemalloc.stop()


def test_a_grid_larger_than_a_map_can_be_is_not_unpacked() -> None:
    with pytest.raises(ValueError, match="at most 8192 cells"):
        unpacked_cells(zlib.compress(b""), GridSpec(1.0, 0.0, 0.0, (1, MAX_SIDE_CELLS + 1)))
