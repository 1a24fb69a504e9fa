"""Several processes write to one store at once, and one of them may be killed: what was reported saved is there."""

import fcntl
import os
import signal
import stat
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from robotd.core.errors import MapError
from robotd.core.grid_spec import GridSpec
from robotd.grid.occupancy import OccupancyGrid
from robotd.maps.lock import sole_writer
from robotd.maps.store import MapStore

SPEC = GridSpec(0.05, 0.0, 0.0, (40, 50))
WRITER = """
import sys
from pathlib import Path
import numpy as np
from robotd.grid.occupancy import OccupancyGrid
from robotd.core.grid_spec import GridSpec
from robotd.maps.store import MapStore

root, first, count = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
store = MapStore(root, keep=1000)
for seed in range(first, first + count):
    cells = np.random.default_rng(seed).integers(0, 256, (40, 50), np.uint8)
    entry = store.save("lab", OccupancyGrid(GridSpec(0.05, 0.0, 0.0, (40, 50)), cells), {"seed": seed}, seed)
    print(seed, entry.version, flush=True)
"""


def writer(root: Path, first: int, count: int) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", WRITER, str(root), str(first), str(count)], stdout=subprocess.PIPE, text=True
    )


def reported(process: subprocess.Popen[str]) -> dict[int, int]:
    """Return which version each seed was reported saved as, once the process has ended."""
    output, _ = process.communicate(timeout=120)
    return {int(version): int(seed) for seed, version in (line.split() for line in output.splitlines())}


def assert_found(root: Path, version: int, seed: int) -> None:
    stored = MapStore(root).load("lab", version)
    grid, entry = stored.grid, stored.entry
    assert entry.metadata == {"seed": seed}
    np.testing.assert_array_equal(grid.cells, np.random.default_rng(seed).integers(0, 256, (40, 50), np.uint8))


def grid_of(seed: int) -> OccupancyGrid:
    return OccupancyGrid(SPEC, np.random.default_rng(seed).integers(0, 256, SPEC.shape, np.uint8))


def test_what_several_processes_saved_at_once_is_all_there(tmp_path: Path) -> None:
    processes = [writer(tmp_path, first, 20) for first in (100, 200, 300)]
    answers = [reported(process) for process in processes]
    assert [process.returncode for process in processes] == [0, 0, 0]
    assert sorted(version for answer in answers for version in answer) == list(range(1, 61))
    for answer in answers:
        for version, seed in answer.items():
            assert_found(tmp_path, version, seed)


def test_a_writer_killed_halfway_neither_blocks_nor_harms_the_others(tmp_path: Path) -> None:
    survivor = writer(tmp_path, 100, 25)
    answers = []
    for first in (1000, 2000, 3000, 4000):
        victim = writer(tmp_path, first, 500)
        assert victim.stdout is not None
        begun = victim.stdout.readline()
        victim.send_signal(signal.SIGKILL)
        rest, _ = victim.communicate(timeout=60)
        lines = (begun + rest).splitlines()
        answers.append({int(version): int(seed) for seed, version in map(str.split, lines)})
    answers.append(reported(survivor))
    assert survivor.returncode == 0
    assert len(answers[-1]) == 25
    for answer in answers:
        assert answer
        for version, seed in answer.items():
            assert_found(tmp_path, version, seed)
    assert all(entry.damage is None for entry in MapStore(tmp_path).list())
    last = MapStore(tmp_path, keep=1000).save("lab", grid_of(7), {"seed": 7}, 7)
    assert_found(tmp_path, last.version, 7)
    assert not list(tmp_path.glob(".tmp-*")), "what the killed left behind goes with the next save"


def test_a_writer_that_does_not_end_is_named_and_nothing_is_changed(tmp_path: Path) -> None:
    with sole_writer(tmp_path):
        before = sorted(tmp_path.rglob("*"))
        with (
            pytest.raises(MapError, match=rf"process {os.getpid()} has been writing to .* nothing was changed"),
            sole_writer(tmp_path, wait_s=0.05),
        ):
            pytest.fail("two writers at once")
        assert sorted(tmp_path.rglob("*")) == before
    with sole_writer(tmp_path, wait_s=0.05):
        pass


def test_readers_ask_no_leave(tmp_path: Path) -> None:
    MapStore(tmp_path).save("lab", grid_of(1), {"seed": 1}, 1)
    with sole_writer(tmp_path):
        assert_found(tmp_path, 1, 1)
        assert [entry.version for entry in MapStore(tmp_path).list()] == [1]


@pytest.mark.parametrize(("directory", "file"), [(0o755, 0o600), (0o775, 0o660), (0o777, 0o666)])
def test_only_who_may_write_there_may_hold_the_lock(tmp_path: Path, directory: int, file: int) -> None:
    (tmp_path / ".lock").touch(0o644)
    tmp_path.chmod(directory)
    with sole_writer(tmp_path):
        assert stat.S_IMODE((tmp_path / ".lock").stat().st_mode) == file


def test_a_lock_file_that_was_removed_meanwhile_keeps_nobody_apart_and_is_not_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = fcntl.flock
    removed: list[Path] = []

    def flock(descriptor: int, operation: int) -> None:
        if not removed:
            removed.append(tmp_path / ".lock")
            removed[0].unlink()
        real(descriptor, operation)

    monkeypatch.setattr(fcntl, "flock", flock)
    with sole_writer(tmp_path), pytest.raises(MapError), sole_writer(tmp_path, wait_s=0.05):
        pytest.fail("two writers at once")


@pytest.mark.parametrize("kind", ["directory", "link", "pipe"])
def test_something_else_in_the_locks_place_is_said(tmp_path: Path, kind: str) -> None:
    place = tmp_path / "maps" / ".lock"
    place.parent.mkdir()
    if kind == "directory":
        place.mkdir()
    elif kind == "link":
        place.symlink_to(tmp_path / "elsewhere")
    else:
        os.mkfifo(place)
    if kind == "pipe":
        assert MapStore(place.parent).save("lab", grid_of(1), {}, 1).version == 1, "it locks as well as a file"
        return
    with pytest.raises(MapError, match="cannot save map lab"):
        MapStore(place.parent).save("lab", grid_of(1), {}, 1)
    assert not (tmp_path / "elsewhere").exists()
