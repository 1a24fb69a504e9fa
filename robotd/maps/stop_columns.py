"""Stops as columns of numbers, little-endian, and back: what is alike lies together, so that it can be packed small."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import msgspec
import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from robotd.core.map_stop import READING, STATUSES, MapStop, StopSlant
from robotd.core.pose import Pose2
from robotd.core.reading import ReadingStatus, Tilt

_FLOAT, _WHOLE, _COUNT, _OCTET = "<f8", "<i8", "<u4", "u1"
_MEASURED = [status in {ReadingStatus.OK, ReadingStatus.MISS} for status in STATUSES]
_GREATEST = 1e6
"""Of coordinates, distances [m] and angles [rad]: the kernels need finite ones, and no robot has others."""


# By keyword alone: then the columns that a kind has more come before these, in files as they always did.
class ReadingColumns(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The readings of some stops, in order."""

    times_ns: bytes
    """Of the readings, int64[m]: each less the one before, the first as it is."""
    bearings_rad: bytes
    """float64[m]."""
    ranges_m: bytes
    """float64[m], 0 for readings that measured nothing."""
    origins_m: bytes
    """Where the beams start, float64[2 m]: all x, then all y."""
    states: bytes
    """Which of ``statuses`` each reading has, uint8[m]."""
    statuses: tuple[ReadingStatus, ...]
    strong: bytes
    """1 for readings that have a strength, else 0, uint8[m]."""
    strengths: bytes
    """int64[m], 0 for readings that have none."""


class StopColumns(ReadingColumns, frozen=True, forbid_unknown_fields=True):
    """Stops in order, and their readings in order."""

    numbers: bytes
    """Of the sweeps, int64[n]."""
    counts: bytes
    """How many readings each stop has, uint32[n]."""
    in_odom: bytes
    """x, y [m] and heading [rad] by odometry, float64[3 n]: all x, then all y, then all headings."""
    in_map: bytes
    """The same on the map."""


class LayerColumns(ReadingColumns, frozen=True, forbid_unknown_fields=True):
    """What was seen from the stops at a further tilt."""

    tilt_rad: float
    cut_off_m: float
    counts: bytes
    """How many readings each stop has at it, uint32[n]; 0 where the robot did not look so."""


def columns_of(stops: tuple[MapStop, ...]) -> StopColumns:
    """Return stops as columns, without what they saw at further tilts."""
    return StopColumns(
        numbers=_packed([stop.number for stop in stops], _WHOLE),
        counts=_packed([len(stop.readings) for stop in stops], _COUNT),
        in_odom=_packed(_poses([stop.in_odom for stop in stops]), _FLOAT),
        in_map=_packed(_poses([stop.map_from_robot for stop in stops]), _FLOAT),
        **_columns([stop.readings for stop in stops]),
    )


def layers_of(stops: tuple[MapStop, ...]) -> tuple[LayerColumns, ...]:
    """Return what stops saw at further tilts as columns."""
    tilts = sorted({slant.tilt for stop in stops for slant in stop.slants}, key=lambda tilt: tilt.tilt_rad)
    return tuple(_layer(tilt, stops) for tilt in tilts)


def _layer(tilt: Tilt, stops: tuple[MapStop, ...]) -> LayerColumns:
    seen = [[slant.readings for slant in stop.slants if slant.tilt == tilt] for stop in stops]
    counts = [sum(map(len, readings)) for readings in seen]
    columns = _columns([readings for some in seen for readings in some])
    return LayerColumns(tilt_rad=tilt.tilt_rad, cut_off_m=tilt.cut_off_m, counts=_packed(counts, _COUNT), **columns)


def _columns(some: Sequence[NDArray[np.void]]) -> dict[str, Any]:
    readings = np.concatenate([np.empty(0, READING), *some])
    return {
        # Steps between readings are small and alike, and pack to little.
        "times_ns": _packed(np.diff(readings["time_ns"], prepend=np.int64(0)), _WHOLE),
        "bearings_rad": _packed(readings["bearing_rad"], _FLOAT),
        "ranges_m": _packed(readings["range_m"], _FLOAT),
        "origins_m": _packed(np.concatenate([readings["origin_x_m"], readings["origin_y_m"]]), _FLOAT),
        "states": _packed(readings["status"], _OCTET),
        "statuses": STATUSES,
        "strong": _packed(readings["has_strength"], _OCTET),
        "strengths": _packed(readings["strength"], _WHOLE),
    }


def stops_of(
    columns: StopColumns, layers: Sequence[LayerColumns], stops_max: int, readings_max: int
) -> tuple[MapStop, ...]:
    """Return the stops that columns say.

    Raises:
        ValueError: they contradict each other or themselves, or there are more stops or readings; says in which.
    """
    counts = _column("counts", columns.counts, _COUNT)
    stops, total = len(counts), int(counts.sum(dtype=np.int64))
    further = [_column("counts", layer.counts, _COUNT, stops) for layer in layers]
    total_of_all = total + sum(int(of_layer.sum(dtype=np.int64)) for of_layer in further)
    if stops > stops_max or total_of_all > readings_max:
        expected = f"expected at most {stops_max} stops of {readings_max} readings"
        raise ValueError(f"{expected}, got {stops} of {total_of_all}")
    numbers = _column("numbers", columns.numbers, _WHOLE, stops)
    in_odom, in_map = _poses_of("in_odom", columns.in_odom, stops), _poses_of("in_map", columns.in_map, stops)
    found = list(map(MapStop, numbers.tolist(), in_odom, in_map, _readings(columns, counts)))
    for layer, of_layer in zip(layers, further, strict=True):
        tilt = _tilt(layer)
        for at, readings in enumerate(_readings(layer, of_layer)):
            if len(readings):
                found[at] = replace(found[at], slants=(*found[at].slants, StopSlant(tilt, readings)))
    return tuple(found)


def _tilt(layer: LayerColumns) -> Tilt:
    if not (abs(layer.tilt_rad) < math.pi / 2 and 0.0 < layer.cut_off_m <= _GREATEST):
        raise ValueError(f"layers: expected a tilt and a cut-off, got {layer.tilt_rad} rad and {layer.cut_off_m} m")
    return Tilt(layer.tilt_rad, layer.cut_off_m)


def _readings(columns: ReadingColumns, counts: NDArray[np.integer]) -> list[NDArray[np.void]]:
    """Return the readings of each stop."""
    readings = _all_readings(columns, int(counts.sum(dtype=np.int64)))
    return np.split(readings, np.cumsum(counts)[:-1]) if len(counts) else []


def _all_readings(columns: ReadingColumns, total: int) -> NDArray[np.void]:
    readings = np.empty(total, READING)
    origins_m = _column("origins_m", columns.origins_m, _FLOAT, 2 * total)
    readings["time_ns"] = np.cumsum(_column("times_ns", columns.times_ns, _WHOLE, total))
    readings["bearing_rad"] = _column("bearings_rad", columns.bearings_rad, _FLOAT, total)
    readings["range_m"] = _column("ranges_m", columns.ranges_m, _FLOAT, total)
    readings["origin_x_m"], readings["origin_y_m"] = origins_m[:total], origins_m[total:]
    readings["strength"] = _column("strengths", columns.strengths, _WHOLE, total)
    readings["status"] = _states(columns, total)
    readings["has_strength"] = _column("strong", columns.strong, _OCTET, total) > 0
    measured = np.array(_MEASURED)[readings["status"]]
    if bool((readings["range_m"][measured] <= 0.0).any()):
        raise ValueError("ranges_m: expected positive ones for hits and misses")
    readings["range_m"][~measured] = 0.0
    # A stop is never changed, and this one was read into an array that could be.
    readings.flags.writeable = False
    return readings


def _states(columns: ReadingColumns, total: int) -> NDArray[np.uint8]:
    states = _column("states", columns.states, _OCTET, total)
    if total and int(states.max()) >= len(columns.statuses):
        raise ValueError(f"states: expected less than {len(columns.statuses)}, got {int(states.max())}")
    codes = np.array([STATUSES.index(status) for status in columns.statuses], np.uint8)
    found: NDArray[np.uint8] = codes[states] if total else states
    return found


def _poses(poses: list[Pose2]) -> list[list[float]]:
    return [[pose.x_m for pose in poses], [pose.y_m for pose in poses], [pose.heading_rad for pose in poses]]


def _poses_of(name: str, data: bytes, count: int) -> tuple[Pose2, ...]:
    numbers = _column(name, data, _FLOAT, 3 * count).reshape(3, count).T
    return tuple(Pose2(*pose) for pose in numbers.tolist())


def _packed(values: ArrayLike, kind: DTypeLike) -> bytes:
    return np.asarray(values, kind).tobytes()


def _column(name: str, data: bytes, kind: str, count: int | None = None) -> NDArray[Any]:
    size = np.dtype(kind).itemsize
    if len(data) % size or (count is not None and len(data) != count * size):
        wanted = "whole numbers" if count is None else f"{count} numbers"
        raise ValueError(f"{name}: expected {wanted} of {size} bytes, got {len(data)} bytes")
    numbers = np.frombuffer(data, kind)
    if kind == _FLOAT and not bool((np.abs(numbers) <= _GREATEST).all()):
        raise ValueError(f"{name}: expected finite numbers up to {_GREATEST:g}")
    return numbers
