"""Each call that locks the runtime directory may fail: the start ends with words, and no descriptor stays behind."""

import errno
import fcntl
import os
from pathlib import Path
from typing import Any

import pytest

from robotd.app.daemon_lock import lock_directory
from robotd.core.errors import TransportError

NUMBERS = [errno.EMFILE, errno.ENOSPC, errno.EACCES, errno.ENOLCK]
CALLS: dict[str, Any] = {"open": os, "fchmod": os, "flock": fcntl}
UNHEEDED: dict[str, Any] = {"ftruncate": os, "pwrite": os}


def failing(error: Exception) -> Any:
    def fail(*_: object, **__: object) -> None:
        raise error

    return fail


def descriptors() -> set[str]:
    return {entry.name for entry in Path("/proc/self/fd").iterdir()}


@pytest.mark.parametrize("number", NUMBERS, ids=errno.errorcode.get)
@pytest.mark.parametrize("call", [*CALLS, "mkdir"])
def test_an_error_of_the_system_is_told_in_words_and_the_next_start_succeeds(
    call: str, number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = descriptors()
    with monkeypatch.context() as broken:
        broken.setattr(CALLS.get(call, Path), call, failing(OSError(number, os.strerror(number))))
        with pytest.raises(TransportError) as caught, lock_directory(tmp_path):
            raise AssertionError("it was not locked")
    assert str(caught.value) == f"runtime directory {tmp_path}: {os.strerror(number)}"
    assert descriptors() == before
    with lock_directory(tmp_path):
        assert (tmp_path / "robotd.lock").read_text() == f"{os.getpid()}\n"


@pytest.mark.parametrize("number", NUMBERS, ids=errno.errorcode.get)
@pytest.mark.parametrize("call", UNHEEDED)
def test_what_only_tells_whose_lock_it_is_may_fail(
    call: str, number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(UNHEEDED[call], call, failing(OSError(number, os.strerror(number))))
    with lock_directory(tmp_path), pytest.raises(TransportError, match="another robotd"), lock_directory(tmp_path):
        raise AssertionError("it was locked twice")


@pytest.mark.parametrize("number", NUMBERS, ids=errno.errorcode.get)
def test_a_holder_whose_number_cannot_be_read_is_unknown(
    number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "pread", failing(OSError(number, os.strerror(number))))
    with (
        lock_directory(tmp_path),
        pytest.raises(TransportError, match=r"\(process unknown\)"),
        lock_directory(tmp_path),
    ):
        raise AssertionError("it was locked twice")


def test_an_error_while_it_is_given_up_ends_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    close = os.close

    def fail(descriptor: int) -> None:
        close(descriptor)
        raise OSError(errno.EIO, os.strerror(errno.EIO))

    with monkeypatch.context() as broken:
        broken.setattr(os, "close", fail)
        with lock_directory(tmp_path):
            pass
    with lock_directory(tmp_path):
        pass


@pytest.mark.parametrize("call", [*CALLS, *UNHEEDED])
def test_an_unexpected_exception_leaves_no_descriptor_and_no_lock(
    call: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = descriptors()
    with monkeypatch.context() as broken:
        broken.setattr((CALLS | UNHEEDED)[call], call, failing(RuntimeError("a bug in the daemon")))
        with pytest.raises(RuntimeError), lock_directory(tmp_path):
            raise AssertionError("it was not locked")
    assert descriptors() == before
    with lock_directory(tmp_path):
        pass
