"""A recording of ours, written by ``robotctl export`` and read by the programs of others, and by ours."""

import base64
import json
import math
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

from robotd.app.replaying import replay_events
from robotd.cli.main import main
from robotd.contract.estimate import PoseEstimate
from robotd.contract.events import Event, MapChanged, SweepDone
from robotd.core.pose import Odometry, Pose2
from robotd.core.reading import ReadingStatus
from robotd.interop.fan import from_axis_m
from robotd.sim.buildings.log_file import read_log
from tests.studies.interop.trip import Trip, size_bytes
from tests.support.recorded_session import laid_together
from tests.support.tum_reader import decode_tum

_AIM_M = 0.02
"""How far a beam's end is off where a head's aim is taken for even steps."""


@dataclass(frozen=True, slots=True)
class _Told:
    """What the recorded robot told."""

    recording: Path
    directory: Path
    events: Sequence[Event]

    @property
    def best(self) -> list[Pose2]:
        """All poses, predicted ones included."""
        return [event.best for event in self.events if isinstance(event, PoseEstimate) and event.best is not None]

    @property
    def ends(self) -> list[complex]:
        """Where the beams of all sweeps ended, in the frame of odometry."""
        sweeps = [event.sweep for event in self.events if isinstance(event, SweepDone)]
        return [
            _at(sweep.in_odom, from_axis_m(one), one.bearing_rad)
            for sweep in sweeps
            for one in sweep.readings
            if one.status is ReadingStatus.OK
        ]

    def export(self, kind: str, name: str, *options: str) -> Path:
        """Write it, and return where."""
        file = self.directory / name
        with redirect_stdout(StringIO()):
            assert main(["export", kind, str(self.recording), str(file), *options]) == 0
        return file


def trips(recording: Path, directory: Path) -> Iterator[Trip]:
    """Yield how far each form is from what was told."""
    events: list[Event] = []
    replay_events(recording, events.append)
    told = _Told(recording, directory, events)
    yield from _tum(told)
    yield _sweeps(told, "CARMEN", told.export("carmen", "out.clf"), "ours")
    yield _foxglove(told)
    for form, name in (("ROS 1 bag", "out.bag"), ("ROS 2 bag, mcap", "out")):
        bag = told.export("bag", name)
        yield _sweeps(told, f"{form}, sweeps", bag, "rosbags, ours")
        yield _poses(told, f"{form}, odometry", bag)
    yield _by_mcap_ros2(told, directory / "out" / "out.mcap")


def _tum(told: _Told) -> Iterator[Trip]:
    file = told.export("tum", "out.tum", "--predicted")
    read = [timed.pose for timed in decode_tum(file.read_text().splitlines())]
    worst = max(_apart(a, b) for a, b in zip(read, told.best, strict=True))
    holds = f"{len(read)} poses"
    yield Trip("TUM", "out, in", size_bytes(file), holds, worst, 1e-9, "m, rad", "ours")
    evo = shutil.which("evo_traj", path=str(Path(sys.executable).parent)) or shutil.which("evo_traj")
    if evo is None:
        print("evo is not installed (pip install evo): its line is left out", file=sys.stderr)
        return
    said = subprocess.run([evo, "tum", str(file)], capture_output=True, text=True, check=True).stdout
    missing = 0.0 if f"{len(read)} poses" in said else math.inf
    yield Trip("TUM", "out", size_bytes(file), holds, missing, 0.0, "poses", "evo")


def _sweeps(told: _Told, form: str, path: Path, reader: str) -> Trip:
    log = read_log(path)
    read = [
        _at(scan.odometry, range_m, angle_rad)
        for scan in log.scans
        for range_m, angle_rad in zip(scan.ranges_m[scan.hit], scan.angles_rad[scan.hit], strict=True)
    ]
    # Clockwise sweeps were turned round: each end is compared with the nearest that was told.
    sent = np.array(told.ends)
    worst_m = max(float(np.abs(sent - one).min()) for one in read) if len(read) == len(sent) else math.inf
    holds = f"{len(log.scans)} sweeps, {len(read)} hits"
    return Trip(form, "out, in", size_bytes(path), holds, worst_m, _AIM_M, "m", reader)


def _poses(told: _Told, form: str, bag: Path) -> Trip:
    with AnyReader([bag]) as reader:
        some = [one for one in reader.connections if one.topic == "/odom"]
        read = [_pose(reader.deserialize(data, one.msgtype)) for one, _, data in reader.messages(some)]
    sent = [event.in_odom for event in told.events if isinstance(event, Odometry)]
    worst = max(_apart(a, b) for a, b in zip(read, sent, strict=True))
    return Trip(form, "out", size_bytes(bag), f"{len(read)} poses", worst, 1e-6, "m, rad", "rosbags")


def _by_mcap_ros2(told: _Told, file: Path) -> Trip:
    with file.open("rb") as opened:
        messages = make_reader(opened, decoder_factories=[DecoderFactory()]).iter_decoded_messages(topics=["/pose"])
        read = [_pose(one.decoded_message) for one in messages]
    worst = max(_apart(a, b) for a, b in zip(read, told.best, strict=True))
    return Trip(
        "ROS 2 bag, poses", "out", size_bytes(file), f"{len(read)} poses", worst, 1e-6, "m, rad", "mcap-ros2-support"
    )


def _foxglove(told: _Told) -> Trip:
    file = told.export("foxglove", "out-foxglove.mcap")
    with file.open("rb") as opened:
        messages = [
            (channel.topic, json.loads(message.data))
            for schema, channel, message in make_reader(opened).iter_messages()
            if schema is not None and schema.name.startswith("foxglove.")
        ]
    grids = [content for topic, content in messages if topic == "/map"]
    sent = laid_together([event for event in told.events if isinstance(event, MapChanged)])
    came = np.frombuffer(base64.b64decode(grids[-1]["data"]), np.uint8)
    worst = float((came != sent.ravel()).sum())
    counts = f"{len(messages)} messages, {len(grids)} maps"
    return Trip("Foxglove MCAP", "out", size_bytes(file), counts, worst, 0.0, "cells", "mcap")


def _pose(message: Any) -> Pose2:
    pose = message.pose.pose
    turn = pose.orientation
    return Pose2(pose.position.x, pose.position.y, 2 * math.atan2(turn.z, turn.w))


def _at(pose: Pose2, range_m: float, bearing_rad: float) -> complex:
    turned_rad = pose.heading_rad + bearing_rad
    return complex(pose.x_m + range_m * math.cos(turned_rad), pose.y_m + range_m * math.sin(turned_rad))


def _apart(first: Pose2, second: Pose2) -> float:
    turned_rad = abs(math.remainder(first.heading_rad - second.heading_rad, math.tau))
    return max(first.distance_m(second), turned_rad)
