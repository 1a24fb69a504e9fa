"""Replay in process: the same bytes in give the same sweeps, estimates and maps out."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from firmware_proto.framing import Deframer, encode_frame
from firmware_proto.rangefinder_messages import Shot, ShotStatus
from robotd.app.replaying import replay_recording
from robotd.core.clock import run_virtual
from robotd.recording.comparison import RESULTS
from robotd.recording.entries import BytesEntry
from robotd.recording.reader import read
from robotd.recording.recorder import Recorder

from .test_fake_robot import record

pytestmark = pytest.mark.slow


@pytest.fixture(name="recorded")
def _recorded(live: Any, tmp_path: Path) -> Path:
    run_virtual(record(live, tmp_path / "recordings" / "a.mcap"))
    return tmp_path / "recordings" / "a.mcap"


def test_two_replays_come_to_what_was_recorded(recorded: Path) -> None:
    first, second = replay_recording(recorded), replay_recording(recorded)
    assert first.differences == ()
    assert first.results > 5
    assert first.digest == second.digest == first.recorded_digest


@pytest.mark.parametrize("share", [0.3, 0.6, 0.9])
def test_a_cut_recording_is_replayed_up_to_the_cut(recorded: Path, share: float) -> None:
    whole = recorded.read_bytes()
    recorded.write_bytes(whole[: int(share * len(whole))])
    report = replay_recording(recorded)
    assert not report.complete
    assert report.differences == ()


def with_another_range(data: bytes) -> bytes | None:
    """Return a chunk with its first good shot 100 mm farther; None if it holds none."""
    frames = Deframer().feed(data)
    for at, frame in enumerate(frames):
        shot = Shot.from_payload(frame.payload) if frame.type == Shot.TYPE else None
        if shot is not None and shot.status == ShotStatus.OK:
            farther = replace(shot, range_mm=shot.range_mm + 100)
            frames[at] = replace(frame, payload=farther.to_payload())
            return b"".join(encode_frame(one) for one in frames)
    return None


def test_one_reading_that_differs_is_found_with_time_and_what_was_expected(recorded: Path, tmp_path: Path) -> None:
    recording = read(recorded)
    entries = list(recording.entries)
    at, entry, other = next(
        (at, entry, other)
        for at, entry in enumerate(entries)
        if isinstance(entry, BytesEntry) and entry.device == "rangefinder" and (other := with_another_range(entry.data))
    )
    entries[at] = replace(entry, data=other)
    Recorder(tmp_path / "other.mcap", recording.header, entries).close()
    report = replay_recording(tmp_path / "other.mcap")
    assert report.digest != report.recorded_digest
    first = next(difference for difference in report.differences if difference.expected.startswith("sweep "))
    assert first.time_ns == report.differences[0].time_ns
    assert first.device == RESULTS
    assert first.time_ns > entry.time_ns
    assert first.actual.startswith("sweep ")
    assert first.expected != first.actual
