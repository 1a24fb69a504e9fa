"""Whatever fails, and whenever: afterwards there is the old map or the new one, never neither."""

import errno
import os
import shutil
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robotd.core.errors import MapError
from robotd.grid.occupancy import OccupancyGrid
from robotd.maps import atomic
from robotd.maps.store import MapStore
from tests.support.made_maps import SPEC, made_stops

CHANGING = ("open", "write", "fsync", "rename", "mkdir")


class Killed(BaseException):
    """The process ended here."""


def grid_of(seed: int) -> OccupancyGrid:
    return made_stops(seed).grid_on(SPEC)


class FaultyOs:
    """:mod:`os`, but the ``at``-th call that changes the disk goes wrong."""

    def __init__(self, at: int, fault: Callable[[Callable[..., Any], tuple[Any, ...]], Any], *, for_ever: bool) -> None:
        self.calls = 0
        self._at = at
        self._fault = fault
        self._for_ever = for_ever

    def __getattr__(self, name: str) -> Any:
        real = getattr(os, name)
        if name not in CHANGING:
            return real

        def call(*arguments: Any) -> Any:
            self.calls += 1
            if self.calls == self._at or (self._for_ever and self.calls > self._at):
                return self._fault(real, arguments)
            return real(*arguments)

        return call


def killed_before(real: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    raise Killed


def killed_after(real: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    done = real(*arguments)
    if real is os.open:
        os.close(done)
    raise Killed


def disk_full(real: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    raise OSError(errno.ENOSPC, "No space left on device")


def disk_broken(real: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    raise OSError(errno.EIO, "Input/output error")


def half_written_then_killed(real: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    if real is os.write:
        real(arguments[0], arguments[1][: len(arguments[1]) // 2])
    raise Killed


def short_write(real: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    if real is os.write:
        return real(arguments[0], arguments[1][: max(1, len(arguments[1]) // 3)])
    return real(*arguments)


FAULTS = [killed_before, killed_after, disk_full, disk_broken, half_written_then_killed, short_write]


@pytest.fixture(name="two_versions")
def _two_versions(tmp_path: Path) -> Path:
    store = MapStore(tmp_path / "template", keep=2)
    store.save("lab", grid_of(1), {}, 1, made_stops(1))
    store.save("lab", grid_of(2), {}, 2, made_stops(2))
    return tmp_path / "template"


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("for_ever", [False, True])
def test_a_fault_at_any_call_leaves_the_old_map_or_the_new(
    two_versions: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fault: Any, for_ever: bool
) -> None:
    at = saved = failed = 0
    while True:
        at += 1
        root = tmp_path / f"case-{at}"
        shutil.copytree(two_versions, root)
        faulty = FaultyOs(at, fault, for_ever=for_ever)
        with monkeypatch.context() as patch:
            patch.setattr(atomic, "os", faulty)
            reported = save_and_report(root)
        assert_old_or_new(root, must_be_new=reported == "saved")
        saved += reported == "saved"
        failed += reported != "saved"
        if faulty.calls < at:
            break
    assert at > 18, "the faults reached every call"
    assert saved >= 1, "without a fault it is saved"
    assert failed >= 10 or fault is short_write


def save_and_report(root: Path) -> str:
    try:
        MapStore(root, keep=2).save("lab", grid_of(3), {}, 3, made_stops(3))
    except MapError as error:
        return str(error)
    except Killed:
        return "killed"
    return "saved"


def assert_old_or_new(root: Path, *, must_be_new: bool) -> None:
    store = MapStore(root, keep=2)
    stored = store.load("lab")
    grid, entry = stored.grid, stored.entry
    assert entry.version in ({3} if must_be_new else {2, 3})
    np.testing.assert_array_equal(grid.cells, grid_of(entry.version).cells)
    assert stored.stops == made_stops(entry.version)
    for listed in store.list():
        assert listed.damage is None
        store.load("lab", listed.version)
    later = store.save("lab", grid_of(9), {}, 9)
    assert later.version == entry.version + 1
    assert not list(root.glob(".tmp-*")), "nothing is left behind"


@dataclass
class File:
    """Content as the program sees it, and as it would be after a power cut."""

    live: bytes = b""
    durable: bytes = b""


@dataclass
class Directory:
    """Names as the program sees them, and as they would be after a power cut."""

    live: dict[str, "File | Directory"] = field(default_factory=dict)
    durable: dict[str, "File | Directory"] = field(default_factory=dict)


class PowerlessOs(FaultyOs):
    """:mod:`os`, on a disk that forgets what was not synced when the power goes before the ``at``-th call."""

    def __init__(self, root: Path, at: int, *, names_are_eager: bool) -> None:
        super().__init__(at, killed_before, for_ever=True)
        self._root = root
        self._eager = names_are_eager
        self._open: dict[int, File | Directory] = {}
        self.disk = self._image(root)

    def __getattr__(self, name: str) -> Any:
        call = super().__getattr__(name)
        note = getattr(type(self), f"_note_{name}", None)
        if note is None:
            return call

        def noted(*arguments: Any) -> Any:
            done = call(*arguments)
            note(self, done, *arguments)
            if self._eager:
                self._make_names_durable(self.disk)
            return done

        return noted

    def _image(self, path: Path) -> Directory:
        inner = {p.name: self._image(p) if p.is_dir() else File(p.read_bytes(), p.read_bytes()) for p in path.iterdir()}
        return Directory(dict(inner), dict(inner))

    def _node(self, path: Path) -> "File | Directory":
        node: File | Directory = self.disk
        for part in Path(path).relative_to(self._root).parts:
            assert isinstance(node, Directory)
            node = node.live[part]
        return node

    def _directory(self, path: Path) -> Directory:
        node = self._node(path)
        assert isinstance(node, Directory)
        return node

    def _make_names_durable(self, directory: Directory) -> None:
        directory.durable = dict(directory.live)
        for node in directory.live.values():
            if isinstance(node, Directory):
                self._make_names_durable(node)

    def _note_open(self, descriptor: int, path: Path, flags: int, *_: Any) -> None:
        if flags & os.O_CREAT:
            self._directory(path.parent).live[path.name] = File()
        self._open[descriptor] = self._node(path)

    def _note_write(self, written: int, descriptor: int, data: memoryview) -> None:
        node = self._open[descriptor]
        assert isinstance(node, File)
        node.live += bytes(data[:written])

    def _note_fsync(self, _: None, descriptor: int) -> None:
        node = self._open[descriptor]
        if isinstance(node, File):
            node.durable = node.live
        else:
            node.durable = dict(node.live)

    def _note_mkdir(self, _: None, path: Path, *__: Any) -> None:
        self._directory(path.parent).live[path.name] = Directory()

    def _note_rename(self, _: None, source: Path, target: Path) -> None:
        self._directory(target.parent).live[target.name] = self._directory(source.parent).live.pop(source.name)

    def write_what_is_left(self, to: Path) -> None:
        self._write_directory(self.disk, to)

    def _write_directory(self, directory: Directory, to: Path) -> None:
        to.mkdir()
        for name, node in directory.durable.items():
            if isinstance(node, File):
                (to / name).write_bytes(node.durable)
            else:
                self._write_directory(node, to / name)


@pytest.mark.parametrize("names_are_eager", [False, True])
def test_a_power_cut_at_any_call_leaves_the_old_map_or_the_new(
    two_versions: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, names_are_eager: bool
) -> None:
    at = 0
    outcomes = []
    while True:
        at += 1
        root, after = tmp_path / f"case-{at}", tmp_path / f"after-{at}"
        shutil.copytree(two_versions, root)
        powerless = PowerlessOs(root, at, names_are_eager=names_are_eager)
        with monkeypatch.context() as patch:
            patch.setattr(atomic, "os", powerless)
            outcomes.append(save_and_report(root))
        powerless.write_what_is_left(after)
        assert_old_or_new(after, must_be_new=outcomes[-1] == "saved")
        if powerless.calls < at:
            break
    assert outcomes[0] == "killed"
    assert outcomes[-1] == "saved"


def test_the_first_map_of_all_survives_a_power_cut_once_it_is_saved(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "home").mkdir()
    powerless = PowerlessOs(tmp_path / "home", 1000, names_are_eager=False)
    with monkeypatch.context() as patch:
        patch.setattr(atomic, "os", powerless)
        MapStore(tmp_path / "home" / "maps").save("lab", grid_of(1), {}, 1, made_stops(1))
    powerless.write_what_is_left(tmp_path / "after")
    grid = MapStore(tmp_path / "after" / "maps").load("lab").grid
    np.testing.assert_array_equal(grid.cells, grid_of(1).cells)


def test_a_model_of_the_disk_without_syncs_would_lose_the_map(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The power cut test can fail: without fsync the map is gone."""
    powerless = PowerlessOs(tmp_path, 1000, names_are_eager=True)
    monkeypatch.setattr(PowerlessOs, "_note_fsync", lambda *_: None)
    with monkeypatch.context() as patch:
        patch.setattr(atomic, "os", powerless)
        MapStore(tmp_path).save("lab", grid_of(1), {}, 1, made_stops(1))
    powerless.write_what_is_left(tmp_path / "after")
    with pytest.raises(MapError, match="is damaged"):
        MapStore(tmp_path / "after").load("lab")


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_while_a_kept_map_is_saved_leaves_it_kept_or_saved(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fault: Any
) -> None:
    MapStore(tmp_path / "template").save("lab", grid_of(3), {"unsaved": True}, 1, made_stops(3))
    at = 0
    while True:
        at += 1
        root = tmp_path / f"case-{at}"
        shutil.copytree(tmp_path / "template", root)
        faulty = FaultyOs(at, fault, for_ever=False)
        with monkeypatch.context() as patch:
            patch.setattr(atomic, "os", faulty)
            reported = save_and_report(root)
        stored = MapStore(root).load("lab")
        grid, entry = stored.grid, stored.entry
        np.testing.assert_array_equal(grid.cells, grid_of(3).cells)
        assert entry.version == 1
        assert reported != "saved" or not entry.is_unsaved
        if faulty.calls < at:
            break
    assert at > 5, "the faults reached every call"


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_while_a_growing_map_is_kept_again_leaves_the_earlier_or_the_later(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fault: Any
) -> None:
    MapStore(tmp_path / "template").save("lab", grid_of(1), {"unsaved": True}, 1)
    at = 0
    while True:
        at += 1
        root = tmp_path / f"case-{at}"
        shutil.copytree(tmp_path / "template", root)
        faulty = FaultyOs(at, fault, for_ever=False)
        with monkeypatch.context() as patch:
            patch.setattr(atomic, "os", faulty)
            was_kept = _keep_again(root)
        grid = MapStore(root).load("lab").grid
        is_later = bool((grid.cells == grid_of(2).cells).all())
        assert is_later or bool((grid.cells == grid_of(1).cells).all())
        assert is_later or not was_kept
        if faulty.calls < at:
            break
    assert at > 10, "the faults reached every call"


def _keep_again(root: Path) -> bool:
    try:
        MapStore(root).save("lab", grid_of(2), {"unsaved": True}, 2, in_place_of=("lab", 1))
    except (MapError, Killed):
        return False
    return True
