"""What was recorded: listed newest first, removed by the names that are listed and by no others."""

import os
from pathlib import Path

import pytest

from robotd.core.errors import RecordingError
from robotd.recording.shelf import delete_recording, list_recordings


@pytest.fixture
def shelf(tmp_path: Path) -> Path:
    root = tmp_path / "recordings"
    (root / "monday").mkdir(parents=True)
    (root / "maps" / "lab").mkdir(parents=True)
    for at, name in enumerate(("old.mcap", "monday/new.mcap", "notes.txt", "maps/lab/odd.mcap", "now.mcap")):
        (root / name).write_bytes(bytes(at))
        os.utime(root / name, ns=(0, at))
    (tmp_path / "secret.mcap").write_bytes(b"secret")
    (root / "link.mcap").symlink_to(tmp_path / "secret.mcap")
    return root


def paths(root: Path, under_way: Path | None = None) -> list[tuple[str, int, bool]]:
    found = list_recordings(root, root / "maps", under_way)
    assert found.left_out == 0
    return [(one.path, one.size_bytes, one.is_open) for one in found.recordings]


def test_recordings_are_listed_newest_first_and_nothing_else_is(shelf: Path) -> None:
    assert paths(shelf, shelf / "now.mcap") == [
        ("now.mcap", 4, True),
        ("monday/new.mcap", 1, False),
        ("old.mcap", 0, False),
    ]


def test_there_may_be_none_yet(tmp_path: Path) -> None:
    assert paths(tmp_path / "nowhere") == []


def test_of_very_many_the_newest_are_listed(tmp_path: Path) -> None:
    for at in range(1003):
        (tmp_path / f"{at}.mcap").touch()
        os.utime(tmp_path / f"{at}.mcap", ns=(0, at))
    found = list_recordings(tmp_path, tmp_path / "maps", None)
    assert (len(found.recordings), found.left_out, found.recordings[0].path) == (1000, 3, "1002.mcap")


def test_one_that_is_listed_can_be_deleted(shelf: Path) -> None:
    delete_recording(shelf, shelf / "maps", None, "monday/new.mcap")
    assert [path for path, _, _ in paths(shelf)] == ["now.mcap", "old.mcap"]


@pytest.mark.parametrize(
    "name",
    [
        "../secret.mcap",
        "link.mcap",
        "maps/lab/odd.mcap",
        "notes.txt",
        "nothing.mcap",
        "monday",
        "./old.mcap",
        "/old.mcap",
    ],
)
def test_what_is_not_listed_is_not_deleted(shelf: Path, name: str) -> None:
    before = sorted(shelf.rglob("*"))
    with pytest.raises(RecordingError, match="there is no recording"):
        delete_recording(shelf, shelf / "maps", None, name)
    assert sorted(shelf.rglob("*")) == before


def test_the_recording_under_way_is_not_deleted(shelf: Path) -> None:
    with pytest.raises(RecordingError, match="record stop"):
        delete_recording(shelf, shelf / "maps", shelf / "now.mcap", "now.mcap")


def test_a_disk_that_refuses_is_named(shelf: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_: Path) -> None:
        raise OSError(30, "Read-only file system")

    monkeypatch.setattr(Path, "unlink", refuse)
    with pytest.raises(RecordingError, match=r"cannot delete .old\.mcap.: Read-only"):
        delete_recording(shelf, shelf / "maps", None, "old.mcap")
