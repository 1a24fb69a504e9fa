"""``record start``, ``stop``, ``list``, ``delete`` and ``info``, and ``replay``."""

import argparse
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from robotd.cli.connection import connect
from robotd.cli.exit_codes import FAILED, OK
from robotd.cli.inputs import RECORDING_HELP, input_argument
from robotd.cli.show.terminal import complain, out, print_json, print_pairs, print_table
from robotd.cli.verb import Verb
from robotd.contract.answers import RecordingInfo
from robotd.core.clock import NS_PER_S
from robotd.recording.entries import BytesEntry
from robotd.recording.reader import Recording, read

if TYPE_CHECKING:
    from robotd.app.replaying import ReplayReport


def _start(arguments: argparse.Namespace) -> int:
    with connect(arguments) as client:
        path = client.record_start(None if arguments.file is None else str(arguments.file))
    return _tell(arguments, f"recording to {path}", {"path": path})


def _stop(arguments: argparse.Namespace) -> int:
    with connect(arguments) as client:
        path = client.record_stop()
    return _tell(arguments, f"recorded {path}" if path else "nothing was being recorded", {"path": path})


def _list(arguments: argparse.Namespace) -> int:
    with connect(arguments) as client:
        found = client.record_list()
    if arguments.json:
        print_json(msgspec.to_builtins(found))
        return OK
    rows = [
        (one.path, _size(one.size_bytes), _when(one), "under way" if one.is_open else "") for one in found.recordings
    ]
    print_table(("recording", "size", "written to last", ""), rows)
    if found.left_out:
        out().print(f"and {found.left_out} older ones")
    return OK


def _size(size_bytes: int) -> str:
    return f"{size_bytes / 1e6:.1f} MB"


def _when(one: RecordingInfo) -> str:
    return f"{datetime.fromtimestamp(one.changed_unix_ns // NS_PER_S, UTC):%Y-%m-%d %H:%M:%S} UTC"


def _delete(arguments: argparse.Namespace) -> int:
    with connect(arguments) as client:
        client.record_delete(arguments.path)
    return _tell(arguments, f"deleted {arguments.path}", {"path": arguments.path})


def _path(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("path", metavar="RECORDING", help="as robotctl record list names it")


def _tell(arguments: argparse.Namespace, words: str, document: dict[str, Any]) -> int:
    if arguments.json:
        print_json(document)
    else:
        out().print(words)
    return OK


def _info(arguments: argparse.Namespace) -> int:
    recording = read(arguments.file)
    facts = _facts(recording)
    if arguments.json:
        print_json({"file": str(arguments.file), **facts})
    else:
        _print_facts(facts)
        if recording.damage:
            complain(f"{arguments.file}: damaged: {recording.damage}")
    return OK if recording.complete else FAILED


def _print_facts(facts: dict[str, Any]) -> None:
    started = datetime.fromtimestamp(facts["started_unix_ns"] // NS_PER_S, UTC)
    devices = ", ".join(facts["devices"]) or "no device"
    print_pairs(
        [
            ("made by", f"robotd {facts['robotd_version']}"),
            ("began", f"{started:%Y-%m-%d %H:%M:%S} UTC"),
            ("lasts", f"{facts['duration_s']:.1f} s"),
            ("holds", f"{facts['entries']} entries, {facts['line_bytes']} bytes of {devices}"),
            ("results", facts["results"]),
            ("whole", "yes" if facts["complete"] else "no"),
        ]
    )


def _facts(recording: Recording) -> dict[str, Any]:
    header = recording.header
    chunks = [entry for entry in recording.entries if isinstance(entry, BytesEntry)]
    return {
        "robotd_version": header.robotd_version,
        "duration_s": (recording.end_ns - header.started_ns) / NS_PER_S,
        "started_unix_ns": header.started_ns + header.wall_offset_ns,
        "entries": len(recording.entries),
        "devices": list(recording.devices),
        "line_bytes": sum(len(entry.data) for entry in chunks),
        "results": len(recording.results),
        "complete": recording.complete,
        "damage": recording.damage,
    }


def _replay(arguments: argparse.Namespace) -> int:
    from robotd.app.replaying import replay_recording  # noqa: PLC0415  # no other verb needs a daemon inside

    report = replay_recording(arguments.file)
    if arguments.json:
        print_json({**asdict(report), "file": str(arguments.file), "same": not report.differences})
    else:
        for difference in report.differences:
            out().print(str(difference))
        out().print(_verdict(report))
        out().print(f"digest {report.digest}")
        if report.differences and report.recorded_by != report.replayed_by:
            out().print(_of_versions(report), markup=False)
    return FAILED if report.differences else OK


def _verdict(report: "ReplayReport") -> str:
    count = len(report.differences)
    verdict = "the same" if not count else f"{count} difference{'s' * (count > 1)}"
    extent = "" if report.complete else ", up to where the recording is damaged"
    return f"{report.results} results in {report.duration_s:.1f} s of recording: {verdict}{extent}"


def _of_versions(report: "ReplayReport") -> str:
    """Say why a recording of another version may differ although nothing is wrong."""
    return (
        f"recorded by robotd {report.recorded_by}, replayed by robotd {report.replayed_by}: between versions"
        " planned ways, and other algorithms, may change, and then a replay leaves the recording there; the CHANGELOG"
        f" names such changes. robotd {report.recorded_by} replays it bit for bit"
    )


def _file(parser: argparse.ArgumentParser) -> None:
    input_argument(parser, "file", RECORDING_HELP, metavar="RECORDING")


def _new_file(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "file",
        nargs="?",
        type=Path,
        help="name of a new file below the daemon's recording.dir (default: one named by the time)",
    )


VERBS = (
    Verb(
        "record start",
        "record every byte of the serial lines, every command and every result",
        "robotctl record start",
        _start,
        _new_file,
        asks_daemon=True,
    ),
    Verb("record stop", "close the recording", "robotctl record stop", _stop, asks_daemon=True),
    Verb(
        "record list",
        "list what the daemon recorded, the newest first",
        "robotctl record list",
        _list,
        asks_daemon=True,
    ),
    Verb(
        "record delete",
        "remove a recording of the daemon's",
        "robotctl record delete monday.mcap",
        _delete,
        _path,
        asks_daemon=True,
    ),
    Verb(
        "record info",
        "say what a recording holds, and whether it is whole",
        "robotctl record info a.mcap",
        _info,
        _file,
    ),
    Verb(
        "replay",
        "run the daemon again on recorded bytes, and compare every result; exit code 1 if one differs",
        "robotctl replay a.mcap",
        _replay,
        _file,
    ),
)
