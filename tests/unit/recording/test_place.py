"""Recordings go below one directory alone, whatever a client asks for."""

from pathlib import Path

import pytest

from robotd.core.errors import RecordingError
from robotd.recording.place import make_place


@pytest.fixture(name="directory")
def _directory(tmp_path: Path) -> Path:
    """``recordings`` beside ``maps``, with links out of it, into the maps, to nowhere and to themselves."""
    directory = tmp_path / "recordings"
    (tmp_path / "maps" / "lab" / "1").mkdir(parents=True)
    (tmp_path / "elsewhere").mkdir()
    directory.mkdir()
    (directory / "out").symlink_to(tmp_path / "elsewhere")
    (directory / "up").symlink_to("..")
    (directory / "lab").symlink_to("../maps/lab")
    (directory / "dangling.mcap").symlink_to(tmp_path / "elsewhere" / "new.mcap")
    (directory / "here").symlink_to(".")
    (directory / "file").write_text("")
    return directory


def everything(root: Path) -> list[Path]:
    return sorted(root.rglob("*"))


@pytest.mark.parametrize("name", ["a.mcap", "day/one/a.mcap", "./a.mcap", "here/a.mcap", "ä b.mcap", "~/a.mcap", "..a"])
def test_a_name_is_taken_from_the_directory_on(directory: Path, name: str) -> None:
    file = make_place(directory, name, directory.parent / "maps")
    assert file.parent.is_dir()
    assert not file.exists()
    assert file == (directory / name.removeprefix("here/")).resolve()
    assert make_place(directory, str(directory / name), directory.parent / "maps") == file, "or written in full"


@pytest.mark.parametrize(
    "name",
    [
        *(
            "../a.mcap",
            "day/../a.mcap",
            "..",
            ".",
            "",
            "a\0b",
            "/",
            "/etc/passwd",
            "//etc/a.mcap",
            "../recordings-2/a.mcap",
        ),
        *("out/a.mcap", "out", "up/a.mcap", "up/maps/lab/9", "lab/9", "dangling.mcap", "here/out/x/y.mcap"),
        *(
            "TMP/maps/lab/9",
            "TMP/maps/.tmp-lab-11",
            "TMP/maps/lab/999999999",
            "TMP/recordings",
            "TMP/recordings-2/a",
            "TMP/a",
        ),
    ],
)
def test_what_leads_elsewhere_is_refused_and_leaves_no_trace(directory: Path, name: str) -> None:
    before = everything(directory.parent)
    with pytest.raises(RecordingError, match=r"recordings go below .*recordings \(recording\.dir\) alone"):
        make_place(directory, name.replace("TMP", str(directory.parent)), directory.parent / "maps")
    assert everything(directory.parent) == before


@pytest.mark.parametrize("maps", ["recordings", "recordings/maps", "."])
def test_the_maps_are_kept_out_wherever_they_are(directory: Path, maps: str) -> None:
    with pytest.raises(RecordingError, match="not among the maps"):
        make_place(directory, "maps/lab/9", directory.parent / maps)


def test_a_directory_that_is_a_link_to_the_maps_is_found_out(directory: Path, tmp_path: Path) -> None:
    (tmp_path / "linked").symlink_to("maps")
    with pytest.raises(RecordingError, match="not among the maps"):
        make_place(tmp_path / "linked", "lab/9", tmp_path / "maps")


def test_the_directory_itself_may_be_a_link_and_need_not_exist(directory: Path, tmp_path: Path) -> None:
    (tmp_path / "linked").symlink_to("recordings")
    assert make_place(tmp_path / "linked", "a.mcap", tmp_path / "maps") == directory / "a.mcap"
    assert (
        make_place(tmp_path / "linked", str(tmp_path / "linked" / "a.mcap"), tmp_path / "maps") == directory / "a.mcap"
    )
    assert make_place(tmp_path / "new" / "one", "b.mcap", tmp_path / "maps").parent.is_dir()


@pytest.mark.parametrize("name", ["file/a.mcap", f"{'a' * 300}/a.mcap"])
def test_a_directory_that_cannot_be_made_is_said(directory: Path, name: str) -> None:
    with pytest.raises(RecordingError, match="cannot record to"):
        make_place(directory, name, directory.parent / "maps")
