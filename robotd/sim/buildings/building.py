"""A real building as a log saw it: the stops of a recorded drive, each with the scan taken there, in one file.

The file is JSON, compressed, with a format name and a version; what it holds is :class:`RecordedBuilding`.
"""

import gzip
import math
import zlib
from dataclasses import dataclass
from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray

from robotd.core.errors import RecordingError
from robotd.core.pose import Pose2
from robotd.logs.scan import RecordedLog, Scan

FORMAT = "robotd recorded building"
VERSION = 1
_LARGEST_BYTES = 256 << 20
"""A building of a hundred thousand beams a stop would be smaller."""

_NEAR_STEPS = 0.75
"""A beam is near a direction within half a step between beams; seen from a little to the side, steps look wider."""


@dataclass(frozen=True, slots=True)
class RecordedStop:
    """One place where the recorded robot was, and what its scanner saw from there."""

    scan: int
    """Number of the scan in the log, from 0."""
    pose: Pose2
    """The robot's pose as the log has it; corrected, in a corrected log."""
    odometry: Pose2
    """What the robot's own odometry believed, in a frame of its own."""
    kept_out: bool
    """Whether it is no stop of the map, but a place to localize at."""
    laser: Pose2
    """Where the scanner sat on the robot."""
    first_rad: float
    """Direction of the first beam in the scanner's frame."""
    step_rad: float
    """From beam to beam."""
    ranges_m: tuple[float | None, ...]
    """Along each beam; null where nothing was measured."""
    missed: tuple[int, ...]
    """Beams from which nothing came back."""

    def __post_init__(self) -> None:
        """Refuse a scan that contradicts itself."""
        if not self.step_rad > 0.0:
            raise ValueError(f"step_rad must be positive, got {self.step_rad}")
        if any(not 0 <= beam < len(self.ranges_m) or self.ranges_m[beam] is not None for beam in self.missed):
            raise ValueError("missed names a beam that there is not, or that has a range")
        if any(range_m is not None and not (math.isfinite(range_m) and range_m > 0.0) for range_m in self.ranges_m):
            raise ValueError("ranges_m must be finite and positive")


@dataclass(frozen=True, slots=True)
class RecordedBuilding:
    """The stops, in the order in which the robot came by."""

    log: str
    """Name of the log they come from."""
    stops: tuple[RecordedStop, ...]
    format: str = FORMAT
    version: int = VERSION

    def __post_init__(self) -> None:
        """Refuse a building without a start."""
        if not self.stops or self.stops[0].kept_out:
            raise ValueError("the first stop must be there, and be one of the map")


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """What a recorded scan shows to a robot that stands at, or near, the recorded place."""

    bearings_rad: NDArray[np.float64]
    """Directions in the frame of that robot, ascending within ``[-pi, pi)``, ``float64[n]``."""
    ranges_m: NDArray[np.float64]
    """Distances from that robot's centre, ``float64[n]``; ``inf`` where nothing came back."""
    step_rad: float
    """Angle between two beams of the scanner."""

    def nearest(self, bearing_rad: float) -> int | None:
        """Return the beam nearest to a direction, None if the scanner did not look there."""
        if not len(self.bearings_rad):
            return None
        missing_rad = np.abs(np.mod(self.bearings_rad - bearing_rad + math.pi, math.tau) - math.pi)
        nearest = int(np.argmin(missing_rad))
        return nearest if missing_rad[nearest] <= _NEAR_STEPS * self.step_rad else None


def view_from(stop: RecordedStop, in_stop: Pose2) -> View:
    """Return what the scan of a stop shows to a robot at pose ``in_stop`` in the frame of the recorded robot.

    Exact for each beam: its end point is carried over, and seen from the centre of the robot that is there now.
    That takes in both that the scanner did not sit on the robot's axis, and that the robot stands a little to the side.
    """
    ranges_m = np.array([math.nan if range_m is None else range_m for range_m in stop.ranges_m], dtype=np.float64)
    angles_rad = stop.first_rad + stop.step_rad * np.arange(len(ranges_m), dtype=np.float64) + stop.laser.heading_rad
    x_m = stop.laser.x_m + ranges_m * np.cos(angles_rad) - in_stop.x_m
    y_m = stop.laser.y_m + ranges_m * np.sin(angles_rad) - in_stop.y_m
    distances_m, directions_rad = np.hypot(x_m, y_m), np.arctan2(y_m, x_m)
    missed = np.array(stop.missed, dtype=np.intp)
    # Where nothing came back there is no end to carry over: what is left is the direction.
    distances_m[missed], directions_rad[missed] = np.inf, angles_rad[missed]
    seen = ~np.isnan(distances_m)
    bearings_rad = np.mod(directions_rad[seen] - in_stop.heading_rad + math.pi, math.tau) - math.pi
    order = np.argsort(bearings_rad, kind="stable")  # beams seen from the side may change places
    return View(bearings_rad[order], distances_m[seen][order], stop.step_rad)


def select_stops(
    log: RecordedLog, spacing_m: float = 1.0, *, keep_out_every: int = 2, limit: int | None = None
) -> tuple[RecordedStop, ...]:
    """Walk a log in file order and take a scan every ``spacing_m`` of travel.

    Straight lines from one stop to the next then follow where the robot once went.

    Args:
        log: the log.
        spacing_m: way between two stops.
        keep_out_every: one stop in this many is kept out of the map, at least 2; 0 keeps none out.
        limit: end the walk after this many stops, at least 1.
    """
    if keep_out_every == 1:
        raise ValueError("keep_out_every 1 keeps every stop out of the map: there would be no map")
    # Where the robot begins, so it must be on the map.
    chosen = [0]
    travelled_m = 0.0
    for index in range(1, len(log.scans)):
        travelled_m += log.scans[index].robot_pose.distance_m(log.scans[index - 1].robot_pose)
        if travelled_m >= spacing_m:
            chosen.append(index)
            travelled_m = 0.0
    return tuple(
        _stop(index, log.scans[index], kept_out=keep_out_every > 0 and number % keep_out_every == keep_out_every - 1)
        for number, index in enumerate(chosen[:limit])
    )


def _stop(index: int, scan: Scan, *, kept_out: bool) -> RecordedStop:
    return RecordedStop(
        scan=index,
        pose=scan.robot_pose,
        odometry=scan.odometry,
        kept_out=kept_out,
        laser=scan.robot_from_laser,
        first_rad=float(scan.angles_rad[0]),
        step_rad=scan.step_rad,
        ranges_m=tuple(float(range_m) if hit else None for range_m, hit in zip(scan.ranges_m, scan.hit, strict=True)),
        missed=tuple(np.flatnonzero(scan.missed).tolist()),
    )


def encode_recorded_building(building: RecordedBuilding) -> bytes:
    """Return the file of a building; the same building, the same bytes."""
    return gzip.compress(msgspec.json.encode(building), mtime=0)


def load_recorded_building(path: Path) -> RecordedBuilding:
    """Return the building of a file.

    Raises:
        RecordingError: the file is missing, damaged, or of another format or version; says which.
    """
    try:
        with gzip.open(path) as file:
            content = file.read(_LARGEST_BYTES + 1)  # bounded: a small file can unpack to any size
        if len(content) > _LARGEST_BYTES:
            raise RecordingError(f"{path}: over {_LARGEST_BYTES >> 20} MiB when unpacked: no recorded building")
        # The header alone first: another version may lay out the rest in another way.
        header = msgspec.json.decode(content, type=_Header)
        if (header.format, header.version) != (FORMAT, VERSION):
            found = f"{header.format!r} version {header.version}"
            raise RecordingError(f"{path}: expected {FORMAT!r} version {VERSION}, found {found}")
        return msgspec.json.decode(content, type=RecordedBuilding)
    except (OSError, EOFError, zlib.error) as error:
        raise RecordingError(f"{path}: {error}") from error
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise RecordingError(f"{path}: damaged: {error}") from error


@dataclass(frozen=True, slots=True)
class _Header:
    """What every version of the file begins with."""

    format: str = ""
    version: int = 0
