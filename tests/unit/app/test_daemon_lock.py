"""One daemon in a runtime directory, and nobody else who could keep it out."""

import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from robotd.app.daemon_lock import lock_directory
from robotd.core.errors import TransportError

READER = """
import fcntl, os, sys
os.setgroups([]); os.setgid(int(sys.argv[2])); os.setuid(65534)
try:
    fcntl.flock(os.open(sys.argv[1] + "/robotd.lock", os.O_RDONLY), fcntl.LOCK_SH)
except PermissionError:
    sys.exit(13)
"""
"""Holds the lock as a member of the daemon's group who may only read would."""
KILLED = """
import fcntl, os, sys
fcntl.flock(os.open(sys.argv[1] + "/robotd.lock", os.O_RDWR | os.O_CREAT), fcntl.LOCK_EX)
os.kill(os.getpid(), 9)
"""


def test_the_second_is_refused_and_told_who_was_first(tmp_path: Path) -> None:
    refused = pytest.raises(TransportError, match=rf"another robotd \(process {os.getpid()}\)")
    with lock_directory(tmp_path), refused:
        lock_directory(tmp_path).__enter__()
    with lock_directory(tmp_path):
        """Free again."""


def test_the_lock_of_a_killed_daemon_is_free(tmp_path: Path) -> None:
    subprocess.run([sys.executable, "-c", KILLED, str(tmp_path)], check=False)
    with lock_directory(tmp_path):
        assert [entry.name for entry in tmp_path.iterdir()] == ["robotd.lock"]


@pytest.mark.parametrize("mode", [None, 0o640, 0o644])
def test_it_is_for_the_daemons_user_alone(tmp_path: Path, mode: int | None) -> None:
    if mode is not None:
        (tmp_path / "robotd.lock").touch(mode)
    with lock_directory(tmp_path):
        assert stat.S_IMODE((tmp_path / "robotd.lock").stat().st_mode) == 0o600


@pytest.mark.skipif(os.getuid() != 0, reason="only root can become somebody else")
def test_a_reader_cannot_keep_the_daemon_out(tmp_path: Path) -> None:
    with lock_directory(tmp_path):
        """The file is there from now on."""
    for directory in (tmp_path, *tmp_path.parents[:2]):
        directory.chmod(0o755)
    words = [sys.executable, "-c", READER, str(tmp_path), str(os.getgid())]
    assert subprocess.run(words, check=False).returncode == 13


def test_one_that_leads_elsewhere_is_refused(tmp_path: Path) -> None:
    (tmp_path / "robotd.lock").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(TransportError, match="runtime directory"):
        lock_directory(tmp_path).__enter__()
    assert not (tmp_path / "elsewhere").exists()


def test_a_runtime_directory_that_cannot_be_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(TransportError, match="file/run"):
        lock_directory(tmp_path / "file" / "run").__enter__()


def test_it_holds_though_there_is_no_room_for_its_owners_number(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.pwrite", full)
    refused = pytest.raises(TransportError, match=r"another robotd \(process unknown\)")
    with lock_directory(tmp_path), refused:
        lock_directory(tmp_path).__enter__()
