import bz2
import gzip
import io
import lzma
import os
import tarfile
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from robotd.core.errors import RecordingError
from robotd.logs.scan import PoseSource, RecordedLog
from robotd.sim.buildings.log_file import read_log
from tests.support.carmen_room import POSES, assert_the_room_is_seen, flaser

TEXT = ("\n".join(flaser()) + "\n").encode()


def read(tmp_path: Path, content: bytes) -> RecordedLog:
    path = tmp_path / "some.log"
    path.write_bytes(content)
    return read_log(path)


def refusal(tmp_path: Path, content: bytes) -> str:
    with pytest.raises(RecordingError) as caught:
        read(tmp_path, content)
    said = str(caught.value)
    assert said.startswith(str(tmp_path / "some.log"))
    assert len(said.splitlines()) == 1
    return said


@pytest.mark.parametrize("pack", [bytes, gzip.compress, bz2.compress, lzma.compress])
def test_a_log_may_be_packed_whatever_its_name(tmp_path: Path, pack: Callable[[bytes], bytes]) -> None:
    assert_the_room_is_seen(read(tmp_path, pack(TEXT)))


WRITTEN = {
    "a byte order mark": b"\xef\xbb\xbf" + TEXT,
    "UTF-16": TEXT.decode().encode("utf-16"),
    "lines end as on Windows": TEXT.replace(b"\n", b"\r\n"),
    "lines end as on old Macs": TEXT.replace(b"\n", b"\r"),
    "tabs": TEXT.replace(b" ", b"\t"),
    "no end of the last line": TEXT.rstrip(),
    "Latin-1 in a comment": b"# aufgezeichnet in G\xf6ttingen\n" + TEXT,
    "UTF-8 in a comment": "# aufgezeichnet in Göttingen, 部屋\n".encode() + TEXT,
    "any byte in a comment": b"# " + bytes(set(range(1, 256)) - {10, 13}) + b"\n" + TEXT,
}


@pytest.mark.parametrize("content", WRITTEN.values(), ids=WRITTEN)
def test_however_its_text_is_written_it_is_read(tmp_path: Path, content: bytes) -> None:
    log = read(tmp_path, content)
    assert_the_room_is_seen(log)
    assert not log.problems


def zipped() -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("a.log", TEXT)
    return file.getvalue()


def tarred() -> bytes:
    file = io.BytesIO()
    with tarfile.open(fileobj=file, mode="w") as archive:
        member = tarfile.TarInfo("a.log")
        member.size = len(TEXT)
        archive.addfile(member, io.BytesIO(TEXT))
    return file.getvalue()


STRANGE = {
    "this is a zip archive; unpack it first": zipped,
    "this is a tar archive; unpack it first": tarred,
    "this is a tar archive": lambda: gzip.compress(tarred()),
    "compressed by zstd; unpack it first": lambda: b"\x28\xb5\x2f\xfd" + bytes(30),
    "a web page": lambda: b"\n<!DOCTYPE html><html>not found</html>",
    "a ROS bag": lambda: b"#ROSBAG V2.0\n" + bytes(50),
    "an MCAP recording": lambda: b"\x89MCAP0\r\n" + bytes(50),
    "a pointer of Git LFS": lambda: b"version https://git-lfs.github.com/spec/v1\noid sha256:0\n",
    "not a text: byte 3 is 0x00": lambda: b"ELF" + bytes(50),
    "is empty": bytes,
    "is empty ": lambda: gzip.compress(b""),
    "is this a CARMEN log?": lambda: b"hello\nworld\n",
    "damaged or cut while packed": lambda: gzip.compress(TEXT)[:-20],
    "damaged or cut while packed ": lambda: lzma.compress(TEXT)[:-40],
    "damaged or cut while packed  ": lambda: bz2.compress(TEXT)[:-40],
    "damaged or cut while packed   ": lambda: gzip.compress(TEXT) + b"and more",
    "damaged or cut while packed    ": lambda: bz2.compress(TEXT)[:30] + bytes(60),
}


@pytest.mark.parametrize(("words", "content"), STRANGE.items(), ids=STRANGE)
def test_what_is_no_log_is_named_for_what_it_is(tmp_path: Path, words: str, content: Callable[[], bytes]) -> None:
    assert words.strip() in refusal(tmp_path, content())


def test_a_log_whose_packing_is_damaged_anywhere_is_refused(tmp_path: Path) -> None:
    packed = gzip.compress(TEXT[:2000])
    for at in range(10, len(packed), 7):
        damaged = packed[:at] + bytes([packed[at] ^ 0xFF]) + packed[at + 1 :]
        with pytest.raises(RecordingError):
            read(tmp_path, damaged)


def test_a_file_that_is_missing_or_a_directory_is_named(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match=r"no\.log: No such file"):
        read_log(tmp_path / "no.log")
    with pytest.raises(RecordingError, match="Is a directory"):
        read_log(tmp_path)


def test_a_dash_is_standard_input(monkeypatch: pytest.MonkeyPatch) -> None:
    reading, writing = os.pipe()
    with open(reading) as piped:  # noqa: PTH123  # a descriptor, not a path
        monkeypatch.setattr("sys.stdin", piped)
        packed = gzip.compress(TEXT)
        assert len(packed) < 60_000, "must fit into the pipe: nobody reads meanwhile"
        os.write(writing, packed)
        os.close(writing)
        assert_the_room_is_seen(read_log(Path("-")))


def test_a_line_without_end_is_damage_and_costs_no_memory(tmp_path: Path) -> None:
    log = read(tmp_path, gzip.compress(b"FLASER 9 " + b"1.0 " * 2_000_000 + b"\n" + TEXT))
    assert_the_room_is_seen(log)
    assert "over 1048576 characters long" in log.problems[0].message


@pytest.fixture
def case_dir(laser_data: Path) -> Path:
    """The small logs that failed once, where they are kept beside the recorded ones."""
    directory = laser_data.parent / "cases"
    if not directory.is_dir():
        pytest.skip(f"no small logs at {directory}")
    return directory


def test_the_logs_that_failed_once_are_read(case_dir: Path) -> None:
    files = sorted(case_dir.glob("c*.log"))
    assert len(files) > 10
    for file in files:
        if "count-wrong" in file.name:
            with pytest.raises(RecordingError, match="31 damaged lines is line 1"):
                read_log(file)
            continue
        log = read_log(file)
        assert len(log.scans) >= 15
        assert len(log.problems) == ("cut" in file.name)
        assert (log.poses is PoseSource.RAW_ODOMETRY) == ("rawlaser" in file.name)
        assert len(log.assumed) == (("urg769" in file.name) + ("maxrange-code" in file.name))
        for scan in log.scans:
            assert scan.hit.sum() > 0.2 * len(scan.hit)


def test_a_log_of_one_pose_has_one_scan(tmp_path: Path) -> None:
    assert_the_room_is_seen(read(tmp_path, flaser(poses=POSES[:1])[0].encode()), 1)
