"""``export tum|carmen|foxglove|bag``: a recording for other programs."""

import argparse
import io
import json
from collections.abc import Callable, Iterator
from pathlib import Path

from mcap.writer import CompressionType, Writer

from robotd.cli.exit_codes import OK
from robotd.cli.heard import HeardRecording
from robotd.cli.inputs import RECORDING_HELP, input_argument
from robotd.cli.outputs import Kind, output_argument, write
from robotd.cli.show.terminal import out, print_json
from robotd.cli.verb import Verb
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import SweepDone
from robotd.core.errors import RecordingError
from robotd.interop.carmen_writer import PlacedSweep, encode_carmen
from robotd.interop.foxglove_messages import SCHEMAS, FoxgloveFrames
from robotd.interop.tum import TimedPose, encode_tum

_MARK = "# Made by robotctl export"
"""What files of lines begin with: only ours are written again, for somebody's log looks just like one."""
_TUM = Kind("a trajectory made by robotctl export", lambda head: head.startswith(_MARK.encode()))
_CARMEN = Kind("a CARMEN log made by robotctl export", lambda head: head.startswith(_MARK.encode()))
_MCAP = Kind("an MCAP file for Foxglove", lambda head: head.startswith(b"\x89MCAP") and b"foxglove" in head)
_BAG1 = Kind("a new bag: bags are not written again", lambda _: False)
_BAG2 = Kind("the directory of a new bag: bags are not written again", may_hold=lambda _: False)
_PROFILE = "foxglove"
"""Marks the files that are ours to write again, and are no recordings."""


def _tum(arguments: argparse.Namespace) -> int:
    states = {PoseState.LOCALIZED} | ({PoseState.PREDICTED} if arguments.predicted else set())
    heard = HeardRecording.of(arguments.file, PoseEstimate)
    poses = [
        TimedPose(heard.unix_s(event.time_ns), event.best)
        for event in heard.events
        if isinstance(event, PoseEstimate) and event.best is not None and event.state in states
    ]
    return _written_lines(arguments, encode_tum(poses), len(poses), "poses")


def _carmen(arguments: argparse.Namespace) -> int:
    heard = HeardRecording.of(arguments.file, PoseEstimate, SweepDone)
    sweeps = list((_on_map if arguments.on_map else _by_odometry)(heard))
    return _written_lines(arguments, encode_carmen(sweeps), len(sweeps), "sweeps")


def _by_odometry(heard: HeardRecording) -> Iterator[PlacedSweep]:
    for event in heard.events:
        if isinstance(event, SweepDone):
            yield PlacedSweep(heard.unix_s(event.time_ns), event.sweep, event.sweep.in_odom)


def _on_map(heard: HeardRecording) -> Iterator[PlacedSweep]:
    """Yield the sweeps that were localized, where they were: their estimate is the first final one after them."""
    waiting: SweepDone | None = None
    for event in heard.events:
        if isinstance(event, SweepDone):
            waiting = event
        elif isinstance(event, PoseEstimate) and event.final and waiting is not None:
            if event.state is PoseState.LOCALIZED and event.best is not None:
                yield PlacedSweep(heard.unix_s(waiting.time_ns), waiting.sweep, event.best)
            waiting = None


def _foxglove(arguments: argparse.Namespace) -> int:
    heard = HeardRecording.of(arguments.file, object)
    written = io.BytesIO()
    writer = Writer(written, compression=CompressionType.NONE)
    writer.start(profile=_PROFILE, library="robotd")
    channels: dict[str, int] = {}
    schemas = {
        name: writer.register_schema(name, "jsonschema", json.dumps(schema).encode())
        for name, schema in SCHEMAS.items()
    }
    frames, count = FoxgloveFrames(heard.wall_offset_ns), 0
    for event in heard.events:
        for message in frames.messages(event):
            if message.topic not in channels:
                channels[message.topic] = writer.register_channel(message.topic, "json", schemas[message.schema])
            unix_ns = frames.unix_ns(event.time_ns)
            writer.add_message(channels[message.topic], unix_ns, json.dumps(message.content).encode(), unix_ns)
            count += 1
    writer.finish()  # type: ignore[no-untyped-call]  # mcap leaves it without types
    return _written(arguments, written.getvalue(), count, "messages")


def _bag(arguments: argparse.Namespace) -> int:
    from robotd.interop.bags_extra import require_bags  # noqa: PLC0415  # only here is the extra needed
    from robotd.interop.ros_bag_writer import write_bag  # noqa: PLC0415  # as above

    require_bags()  # before a long recording is replayed
    heard = HeardRecording.of(arguments.file, object)
    return _told(arguments, write_bag(arguments.out, heard.events, heard.wall_offset_ns), "messages")


def _written_lines(arguments: argparse.Namespace, lines: Iterator[str], count: int, what: str) -> int:
    return _written(arguments, "".join((f"{_MARK}\n", *lines)).encode(), count, what)


def _written(arguments: argparse.Namespace, content: bytes, count: int, what: str) -> int:
    if not count:
        raise RecordingError(f"{arguments.file}: there are no {what} in it to export")
    write(arguments.out, content)
    return _told(arguments, count, what)


def _told(arguments: argparse.Namespace, count: int, what: str) -> int:
    if arguments.json:
        print_json({"file": str(arguments.out), what: count})
    else:
        out().print(f"{arguments.out}: {count} {what}", markup=False)
    return OK


def _bag_arguments(parser: argparse.ArgumentParser) -> None:
    _arguments(_kind_of_bag, "the bag: NAME.bag is one of ROS 1, any other name the directory of one of ROS 2")(parser)


def _kind_of_bag(path: Path) -> Kind:
    return _BAG1 if path.suffix == ".bag" else _BAG2


def _arguments(kind: Kind | Callable[[Path], Kind], summary: str) -> Callable[[argparse.ArgumentParser], None]:
    def add(parser: argparse.ArgumentParser) -> None:
        input_argument(parser, "file", RECORDING_HELP, metavar="RECORDING")
        output_argument(parser, "out", kind, summary)

    return add


def _tum_arguments(parser: argparse.ArgumentParser) -> None:
    _arguments(_TUM, "the trajectory, in the frame of the map")(parser)
    parser.add_argument(
        "--predicted", action="store_true", help="also what odometry predicted between two localizations"
    )


def _carmen_arguments(parser: argparse.ArgumentParser) -> None:
    _arguments(_CARMEN, "the log")(parser)
    parser.add_argument(
        "--on-map", action="store_true", help="the sweeps that were localized, at their places on the map"
    )


VERBS = (
    Verb(
        "export tum",
        "write where a recorded robot was localized as a trajectory that evo reads",
        "robotctl export tum monday.mcap monday.tum --predicted",
        _tum,
        _tum_arguments,
    ),
    Verb(
        "export carmen",
        "write the sweeps of a recording as a CARMEN log, at the poses of odometry",
        "robotctl export carmen monday.mcap monday.clf",
        _carmen,
        _carmen_arguments,
    ),
    Verb(
        "export foxglove",
        "write what a recorded robot told as an MCAP file that Foxglove opens: map, frames, sweeps, poses",
        "robotctl export foxglove monday.mcap monday-foxglove.mcap",
        _foxglove,
        _arguments(_MCAP, "the file to open in Foxglove"),
    ),
    Verb(
        "export bag",
        "write what a recorded robot told as a bag of ROS 1 or ROS 2: map, frames, odometry, sweeps, poses",
        "robotctl export bag monday.mcap monday.bag",
        _bag,
        _bag_arguments,
    ),
)
