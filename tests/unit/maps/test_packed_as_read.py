"""The heart holds no file of a map whole while it reads one: it packs as it reads, and finds all that is wrong."""

import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from robotd.core.errors import MapError
from robotd.core.grid_spec import GridSpec
from robotd.grid.occupancy import OccupancyGrid
from robotd.maps.archive import Archive
from robotd.maps.packed_content import PackedContent
from robotd.maps.store import MapStore
from robotd.maps.version_files import CELLS, IMAGE, YAML

SIDE = 2000
HELD_BYTES = 3 * 2**20
"""A block, what is left of the one before it, and all of the map packed; its files have eight mebibytes."""


@pytest.fixture
def root(tmp_path: Path) -> Path:
    cells = np.full((SIDE, SIDE), 20, np.uint8)
    cells[::100] = 230
    MapStore(tmp_path).save("wide", OccupancyGrid(GridSpec(0.05, 0.0, 0.0, cells.shape), cells), {}, 0)
    return tmp_path


def test_it_is_what_is_on_the_disk_but_for_exports_and_takes_little_memory(root: Path) -> None:
    archive = Archive(root, PackedContent.read)
    tracemalloc.start()
    entry, content = archive.load("wide")
    peak_bytes = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert content.unpacked().files == {CELLS: (entry.path / CELLS).read_bytes()}
    assert peak_bytes < HELD_BYTES < (entry.path / CELLS).stat().st_size


@pytest.mark.parametrize("name", [CELLS, IMAGE, YAML])
def test_what_was_altered_or_cut_off_or_goes_on_is_found_in_exports_too(root: Path, name: str) -> None:
    archive = Archive(root, PackedContent.read)
    file = archive.load("wide")[0].path / name
    right = file.read_bytes()
    for wrong, complaint in (
        (bytes([right[0] ^ 1]) + right[1:], f"{name} was altered"),
        (right[:-1], f"{name} has {len(right) - 1} bytes, expected {len(right)}"),
        (right + b"x", f"{name} is longer than {len(right)} bytes"),
    ):
        file.write_bytes(wrong)
        with pytest.raises(MapError, match=complaint):
            archive.load("wide")
