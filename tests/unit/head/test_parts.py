"""Parts of a map come to the whole, or to an error; whatever a client sends, one map at most is held."""

from hashlib import sha256

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.contract.map_import import LONGEST_PART, MapImport
from robotd.core.errors import MapError
from robotd.core.grid_spec import GridSpec
from robotd.head.desk import Desk
from robotd.head.job_table import perform
from robotd.head.parts import Parts
from robotd.head.parts_jobs import TakePart
from robotd.head.settings import HeadSettings
from robotd.maps.version_files import CELLS

WHOLE = bytes(range(10))
DIGEST = sha256(WHOLE).hexdigest()


def test_parts_come_to_the_whole_and_nothing_is_held_then() -> None:
    parts = Parts()
    assert parts.take(DIGEST, 10, 0, WHOLE[:4]) is None
    assert parts.take(DIGEST, 10, 4, WHOLE[4:]) == WHOLE
    with pytest.raises(MapError, match="begin again"):
        parts.take(DIGEST, 10, 4, WHOLE[4:])


@pytest.mark.parametrize(
    ("size", "offset", "part", "why"),
    [
        (10, 3, b"x", "do not go on at 4"),
        (10, 5, b"x", "do not go on at 4"),
        (10, 4, bytes(7), "do not go on at 4"),
        (10, 4, bytes(6), "another sha256"),
        (11, 4, b"x", "are gone"),
    ],
    ids=("before", "a gap", "too many", "others", "of another"),
)
def test_what_does_not_go_on_is_refused(size: int, offset: int, part: bytes, why: str) -> None:
    parts = Parts()
    parts.take(DIGEST, 10, 0, WHOLE[:4])
    with pytest.raises(MapError, match=why):
        parts.take(DIGEST, size, offset, part)
    assert parts.take(DIGEST, 10, 0, WHOLE) == WHOLE, "who begins again is heard"


def test_another_one_takes_its_place() -> None:
    parts = Parts()
    parts.take(DIGEST, 10, 0, WHOLE[:4])
    assert parts.take(sha256(b"ab").hexdigest(), 2, 0, b"ab") == b"ab"
    with pytest.raises(MapError, match="are gone"):
        parts.take(DIGEST, 10, 4, WHOLE[4:])


@given(st.integers(1, 300), st.integers(1, 300), st.integers(0, 99))
def test_what_a_client_sends_is_the_map_that_is_made(rows: int, cols: int, seed: int) -> None:
    cells = np.random.default_rng(seed).integers(0, 256, (rows, cols), dtype=np.uint8)
    spec = GridSpec(0.05, -1.0, 2.0, (rows, cols))
    desk, requests = Desk(HeadSettings()), list(MapImport.parts("lab", spec, cells))
    assert all(0 < len(one.part) <= LONGEST_PART for one in requests)
    *earlier, last = [
        perform(desk, TakePart(one.spec, one.sha256, one.size_bytes, one.offset_bytes, one.part)) for one in requests
    ]
    assert all(taken.made is None for taken in earlier)
    assert last.made is not None
    content = last.made.content.unpacked()
    assert (content.spec, content.files[CELLS]) == (spec, cells.tobytes())


def test_cells_that_are_not_the_grid_are_no_map() -> None:
    (request,) = MapImport.parts("lab", GridSpec(0.05, 0.0, 0.0, (3, 3)), np.zeros((2, 2), np.uint8))
    part = TakePart(request.spec, request.sha256, request.size_bytes, 0, request.part)
    with pytest.raises(MapError, match="expected 9 bytes of cells"):
        perform(Desk(HeadSettings()), part)
