"""Whatever call of the recorder fails, the daemon that records goes on, and is told."""

import errno
import os
import threading
from pathlib import Path
from typing import Any

import pytest

from robotd.core.errors import RecordingError
from robotd.recording import recorder as module
from robotd.recording.entries import LineEntry, RecordingHeader
from robotd.recording.recorder import Recorder

HEADER = RecordingHeader("0.1.0", "", 1, 0, 0)
CODES = (errno.EMFILE, errno.ENOSPC, errno.EIO, errno.ENOMEM)


@pytest.mark.parametrize("error", [*(OSError(code, os.strerror(code)) for code in CODES), ValueError("a mistake")])
@pytest.mark.parametrize("call", ["write", "finish"])
def test_what_fails_in_its_thread_ends_the_recording_and_is_told(
    call: str, error: Exception, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def fails(*_: Any) -> None:
        raise error

    monkeypatch.setattr(module._ChunkedFile, call, fails)
    recorder = Recorder(tmp_path / "a.mcap", HEADER)
    recorder.note(LineEntry(1, "drive", up=True))
    recorder.close()
    recorder.note(LineEntry(2, "drive", up=False))
    assert recorder.error == str(error)
    assert any(str(error) in message for message in caplog.messages)


@pytest.mark.parametrize("code", CODES)
def test_a_file_that_cannot_be_had_is_a_refusal(code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: Any) -> None:
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(Path, "open", fails)
    with pytest.raises(RecordingError, match=os.strerror(code)):
        Recorder(tmp_path / "a.mcap", HEADER)


def test_without_a_thread_there_is_no_recording_and_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(_: threading.Thread) -> None:
        raise RuntimeError("can't start new thread")

    with monkeypatch.context() as refusing:
        refusing.setattr(threading.Thread, "start", fails)
        with pytest.raises(RecordingError, match="can't start new thread"):
            Recorder(tmp_path / "a.mcap", HEADER)
    assert not (tmp_path / "a.mcap").exists()
