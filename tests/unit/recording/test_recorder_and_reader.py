"""What is recorded is read back; what is damaged is read up to the damage, and says so."""

import errno
import random
import threading
from pathlib import Path
from typing import IO, Any, Self

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.writer import CompressionType, Writer

from robotd.core.errors import RecordingError
from robotd.hardware.link.tap import Direction, Tap
from robotd.recording import encoding
from robotd.recording import recorder as recorder_module
from robotd.recording.entries import (
    BytesEntry,
    CommandEntry,
    ComputedEntry,
    Entry,
    LineEntry,
    RecordingHeader,
    ResultEntry,
)
from robotd.recording.reader import Recording, read
from robotd.recording.recorder import CHUNK_BYTES, Recorder

HEADER = RecordingHeader("0.1.0", '[drive]\nport = "a"\n', 2**63 + 5, 1_700_000_000_000_000_001, 1000)
ENTRIES: tuple[Entry, ...] = (
    LineEntry(1000, "drive", up=True),
    BytesEntry(1001, "drive", Direction.TO_BOARD, b"\x00\x05hello\x00"),
    BytesEntry(1001, "drive", Direction.FROM_BOARD, bytes(range(256))),
    CommandEntry(1002, "localize", {"heading_rad": 0.1, "note": "Übergröße"}),
    BytesEntry(1003, "pantilt", Direction.FROM_BOARD, b""),
    ComputedEntry(1004, "rank", 0),
    ResultEntry(1005, "estimate", {"x_m": 1.25, "regions": [1, 2]}, "abc"),
    LineEntry(1006, "drive", up=False),
)

devices = st.sampled_from(["drive", "pantilt", "rangefinder"])
times_ns = st.integers(0, 2**63 - 1)  # what a monotonic clock of 64 bits can show
json_values = st.dictionaries(st.text(max_size=5), st.integers() | st.text(max_size=5) | st.none(), max_size=3)
entries = st.lists(
    st.builds(BytesEntry, times_ns, devices, st.sampled_from(Direction), st.binary(max_size=300))
    | st.builds(LineEntry, times_ns, devices, st.booleans())
    | st.builds(CommandEntry, times_ns, st.text(max_size=9), json_values)
    | st.builds(ComputedEntry, times_ns, st.text(max_size=9), st.integers(0, 99))
    | st.builds(ResultEntry, times_ns, st.text(max_size=9), json_values, st.text(max_size=9)),
    max_size=20,
)


def record(path: Path, to_record: tuple[Entry, ...]) -> None:
    path.unlink(missing_ok=True)
    recorder = Recorder(path, HEADER)
    for entry in to_record:
        recorder.note(entry)
    recorder.close()
    assert recorder.error is None


def test_a_recorder_is_a_tap(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "a.mcap", HEADER)
    tap: Tap = recorder
    tap.line_changed("drive", 1, up=True)
    tap.bytes_passed("drive", Direction.TO_BOARD, 2, b"x")
    recorder.command(3, "arm", {})
    recorder.computed(4, "insert", 7)
    recorder.result(5, "map", {"cells": 3}, "d")
    recorder.close()
    assert read(tmp_path / "a.mcap").entries == (
        LineEntry(1, "drive", up=True),
        BytesEntry(2, "drive", Direction.TO_BOARD, b"x"),
        CommandEntry(3, "arm", {}),
        ComputedEntry(4, "insert", 7),
        ResultEntry(5, "map", {"cells": 3}, "d"),
    )


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(to_record=entries)
def test_what_is_recorded_is_read_back(tmp_path: Path, to_record: list[Entry]) -> None:
    record(tmp_path / "a.mcap", tuple(to_record))
    recording = read(tmp_path / "a.mcap")
    assert recording == Recording(HEADER, tuple(to_record))
    assert recording.complete


def test_a_recording_knows_its_devices_end_and_results(tmp_path: Path) -> None:
    record(tmp_path / "a.mcap", ENTRIES)
    recording = read(tmp_path / "a.mcap")
    assert recording.devices == ("drive", "pantilt")
    assert recording.end_ns == 1006
    assert recording.results == (ENTRIES[6],)


def chunked_file(path: Path, per_chunk: int) -> bytes:
    """Record ``ENTRIES`` three times over, a few to a chunk, without waiting for the writer's clock."""
    with path.open("wb") as file:
        writer = recorder_module._ChunkedFile(file)
        messages = [(encoding.HEADER_TOPIC, 1000, encoding.encode_header(HEADER))]
        messages += [(topic, e.time_ns, data) for e in ENTRIES * 3 for topic, data in [encoding.encode(e)]]
        for first in range(0, len(messages), per_chunk):
            writer.write(messages[first : first + per_chunk])
        writer.finish()
    return path.read_bytes()


def test_a_recording_cut_at_any_byte_is_read_up_to_the_cut(tmp_path: Path) -> None:
    whole = chunked_file(tmp_path / "whole.mcap", per_chunk=4)
    path = tmp_path / "cut.mcap"
    lengths: list[int] = []
    reasons = set()
    for size in range(len(whole)):
        path.write_bytes(whole[:size])
        try:
            recording = read(path)
        except RecordingError as error:
            assert not lengths, f"the header was there before byte {size}"
            reasons.add(str(error).removeprefix(f"{path} is damaged before its header ends: "))
            continue
        assert recording.header == HEADER
        assert recording.entries == (ENTRIES * 3)[: len(recording.entries)]
        assert not recording.complete
        assert "cut" in str(recording.damage)
        lengths.append(len(recording.entries))
    assert reasons == {"the file is cut"}
    assert lengths == sorted(lengths), "a longer file never gives less"
    assert set(lengths) == {3, 7, 11, 15, 19, 23, 24}, "every whole chunk before the cut is there"


def test_flipped_bits_leave_an_exact_beginning_or_a_typed_error(tmp_path: Path) -> None:
    whole = chunked_file(tmp_path / "whole.mcap", per_chunk=3)
    path = tmp_path / "flipped.mcap"
    chance = random.Random(7)
    refused = damaged = 0
    for position in range(0, len(whole), 2):
        flipped = bytearray(whole)
        flipped[position] ^= 1 << chance.randrange(8)
        path.write_bytes(flipped)
        try:
            recording = read(path)
        except RecordingError:
            refused += 1
            continue
        assert recording.header == HEADER
        assert recording.entries == (ENTRIES * 3)[: len(recording.entries)]
        assert recording.complete is (recording.damage is None)
        assert not recording.complete or len(recording.entries) == len(ENTRIES) * 3
        damaged += not recording.complete
    assert refused > 50
    assert damaged > 500


def test_a_chunk_that_went_missing_ends_the_recording_there(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    whole = chunked_file(path, per_chunk=5)
    second_chunk = [
        at for at in range(len(whole)) if whole[at : at + 1] == b"\x06" and whole[at + 3 : at + 9] == bytes(6)
    ][1]
    path.write_bytes(whole[:second_chunk] + b"\xf0" + whole[second_chunk + 1 :])  # an unknown record, to be skipped
    recording = read(path)
    assert len(recording.entries) == 4
    assert "message 5 is missing" in str(recording.damage)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "damaged before its header"),
        (b"\x89MCAP0", "damaged before its header"),
        (b"#!/bin/sh\nexit 0\n", "is not a recording"),
        (b"\x89MCAP0\r\n" + bytes(500), "is damaged"),
    ],
)
def test_other_files_are_refused_by_name(tmp_path: Path, content: bytes, says: str) -> None:
    path = tmp_path / "other"
    path.write_bytes(content)
    with pytest.raises(RecordingError, match=says):
        read(path)


def test_a_missing_file_and_a_foreign_mcap_file_are_refused(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="No such file"):
        read(tmp_path / "none.mcap")
    path = tmp_path / "foreign.mcap"
    with path.open("wb") as file:
        foreign = recorder_module._ChunkedFile(file)
        foreign.write([("camera", 1, b"{}")])
        foreign.finish()
    with pytest.raises(RecordingError, match="not a recording of robotd"):
        read(path)


def test_an_existing_file_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "a.mcap").write_text("precious")
    with pytest.raises(RecordingError, match="File exists"):
        Recorder(tmp_path / "a.mcap", HEADER)
    assert (tmp_path / "a.mcap").read_text() == "precious"


def test_what_json_cannot_hold_is_refused_at_the_call(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "a.mcap", HEADER)
    with pytest.raises(TypeError):
        recorder.command(1, "arm", {"who": object()})
    recorder.close()
    assert read(tmp_path / "a.mcap").complete


def test_what_happened_earlier_comes_first_however_much_it_is(tmp_path: Path) -> None:
    earlier = tuple(BytesEntry(n, "drive", Direction.FROM_BOARD, bytes(500)) for n in range(1000))
    recorder = Recorder(tmp_path / "a.mcap", HEADER, earlier, queue_bytes=1000)
    recorder.line_changed("drive", 2000, up=False)
    recorder.close()
    assert recorder.error is None
    assert read(tmp_path / "a.mcap").entries == (*earlier, LineEntry(2000, "drive", up=False))


def test_closing_drains_and_what_comes_later_is_dropped(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "a.mcap", HEADER)
    for number in range(5000):
        recorder.computed(number, "job", number)
    recorder.close()
    recorder.close()
    recorder.computed(6000, "job", 6000)
    assert len(read(tmp_path / "a.mcap").entries) == 5000


def test_chunks_stay_small(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = recorder_module._ChunkedFile(file)
        writer.write([("serial/drive/from_board", n, bytes(240)) for n in range(2000)])
        writer.finish()
    from mcap.records import Chunk
    from mcap.stream_reader import StreamReader

    with path.open("rb") as file:
        sizes = [r.uncompressed_size for r in StreamReader(file, emit_chunks=True).records if isinstance(r, Chunk)]
    assert len(sizes) > 5
    assert max(sizes) <= CHUNK_BYTES


class SlowFile:
    """A disk that blocks until it is let go, or fails."""

    def __init__(self, inner: IO[bytes], error: OSError | None) -> None:
        self.inner = inner
        self.error = error
        self.go = threading.Event()
        self.entered = threading.Event()

    def __getattr__(self, name: str) -> Any:
        return getattr(self.inner, name)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.inner.close()

    def flush(self) -> None:
        self.entered.set()
        self.go.wait(10)
        if self.error:
            raise self.error
        self.inner.flush()


def recorder_on(
    monkeypatch: pytest.MonkeyPatch, path: Path, error: OSError | None = None, queue_bytes: int = 10_000
) -> tuple[Recorder, SlowFile]:
    slow: list[SlowFile] = []
    open_really = Path.open

    def open_slowly(self: Path, mode: str = "r") -> Any:
        slow.append(SlowFile(open_really(self, mode), error))
        return slow[0]

    with monkeypatch.context() as patch:
        patch.setattr(Path, "open", open_slowly)
        patch.setattr(recorder_module, "FLUSH_S", 0.01)
        recorder = Recorder(path, HEADER, queue_bytes=queue_bytes)
        assert slow[0].entered.wait(10)
    return recorder, slow[0]


def test_a_disk_that_does_not_keep_up_stops_the_recording_and_not_the_caller(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    recorder, disk = recorder_on(monkeypatch, tmp_path / "a.mcap")
    for number in range(1000):
        recorder.bytes_passed("drive", Direction.FROM_BOARD, number, bytes(100))
    assert recorder.error == "the disk does not keep up with the lines"
    assert "does not keep up" in caplog.text
    disk.go.set()
    recorder.close()
    recording = read(tmp_path / "a.mcap")
    assert recording.complete
    assert [entry.time_ns for entry in recording.entries] == list(range(len(recording.entries)))
    assert 30 < len(recording.entries) < 60


def test_a_full_disk_stops_the_recording_and_not_the_caller(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    recorder, disk = recorder_on(monkeypatch, tmp_path / "a.mcap", OSError(errno.ENOSPC, "No space left on device"))
    disk.go.set()
    recorder.close()
    recorder.bytes_passed("drive", Direction.FROM_BOARD, 1, b"x")
    assert "No space left" in str(recorder.error)
    assert "No space left" in caplog.text


def test_what_was_noted_reaches_the_disk_without_being_closed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recorder_module, "FLUSH_S", 0.01)
    recorder = Recorder(tmp_path / "a.mcap", HEADER)
    recorder.line_changed("drive", 1, up=True)
    synced = threading.Event()
    for _ in range(500):
        if (tmp_path / "a.mcap").stat().st_size > 0 and _entries_on_disk(tmp_path / "a.mcap"):
            break
        synced.wait(0.01)
    else:
        pytest.fail("nothing on disk after five seconds")
    recorder.close()


def _entries_on_disk(path: Path) -> tuple[Entry, ...]:
    try:
        return read(path).entries
    except RecordingError:
        return ()


@pytest.mark.parametrize("compression", [CompressionType.ZSTD, CompressionType.LZ4])
def test_what_another_program_compressed_is_refused_for_its_size_is_anybodys_guess(
    tmp_path: Path, compression: CompressionType
) -> None:
    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = Writer(file, compression=compression)
        writer.start()
        writer.add_message(writer.register_channel("header", "json", 0), 0, encoding.encode_header(HEADER), 0)
        writer.finish()  # type: ignore[no-untyped-call]  # so it is
    with pytest.raises(RecordingError, match=f"a chunk is compressed \\('{compression.name.lower()}'\\)"):
        read(path)
