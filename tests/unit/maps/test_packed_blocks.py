"""The heart unpacks the files of a map piece by piece: what it writes is what was packed, and nothing else."""

import zlib
from hashlib import sha256
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robotd.core.errors import MapError
from robotd.core.grid_spec import GridSpec
from robotd.maps import packed_content
from robotd.maps.archive import Archive
from robotd.maps.packed_content import PackedContent
from robotd.maps.version_files import CELLS, Content, read_content

SPEC = GridSpec(0.05, 0.0, 0.0, (2, 3))
RIGHT = zlib.compress(b"cells" * 1000)


def packed(data: bytes) -> PackedContent:
    return PackedContent(SPEC, "digest", {CELLS: data}, None)


@given(st.lists(st.tuples(st.binary(min_size=1, max_size=40), st.integers(1, 200_000)), max_size=5))
def test_the_pieces_are_the_file_each_time_and_none_is_large(parts: list[tuple[bytes, int]]) -> None:
    file = b"".join(pattern * times for pattern, times in parts)
    blocks = PackedContent.of(Content(SPEC, "digest", {CELLS: file}, None)).blocks()[CELLS]
    for _ in range(2):
        taken = list(blocks)
        assert b"".join(taken) == file
        assert all(0 < len(block) <= 2**20 for block in taken)


@pytest.mark.parametrize("data", [b"", b"no zlib", RIGHT[:-1], RIGHT[:20], RIGHT + b"x", RIGHT[:-1] + b"x"])
def test_what_is_cut_off_or_goes_on_or_was_altered_is_refused(data: bytes) -> None:
    with pytest.raises(MapError, match=r"cells\.bin cannot be unpacked"):
        list(packed(data).blocks()[CELLS])


def test_no_more_is_unpacked_than_a_file_may_have(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(packed_content, "_LONGEST_FILE", 2**21)
    taken: list[bytes] = []
    with pytest.raises(MapError, match="longer than files are"):
        taken.extend(packed(zlib.compress(bytes(2**25))).blocks()[CELLS])
    assert sum(map(len, taken)) <= 2**21


def test_what_is_written_is_what_was_packed(tmp_path: Path) -> None:
    file = bytes(range(256)) * 20_000
    content = Content(SPEC, sha256(file).hexdigest(), {CELLS: file, "map.pgm": b"P5", "map.yaml": b"image"}, None)
    archive = Archive(tmp_path, read_content)
    archive.save("lab", PackedContent.of(content), {}, 0)
    assert archive.load("lab")[1] == content
