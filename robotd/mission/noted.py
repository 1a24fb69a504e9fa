"""Requests as the journal noted them, read back: what does not fit is refused, and no map takes more than its size."""

import base64
import json
from typing import Any, Literal, TypeVar

import msgspec

from robotd.contract.missions import DriveMission, LocalizeMission, MapMission, Mission
from robotd.core.errors import RecordingError
from robotd.core.grid_bytes import packed_cells, unpacked_cells
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.grid.occupancy import OccupancyGrid

_LEASE_MAX_S = 1e9
_QUOTED = 80
"""So many characters of what was wrong are told."""

T = TypeVar("T")


class NotedStop(msgspec.Struct):
    """A stop, and why."""

    reason: str


class NotedRenewal(msgspec.Struct):
    """A mission whose lease was renewed."""

    mission_id: int


class NotedMap(msgspec.Struct):
    """A map that was taken into use."""

    map_id: str
    name: str
    grid: "_PackedGrid"
    robot_in_map: Pose2 | None


class _PackedGrid(msgspec.Struct):
    spec: GridSpec
    cells: str
    """Base64 of the packed cells."""


class NotedStart(msgspec.Struct):
    """A mission that was started."""

    kind: Literal["MapMission", "LocalizeMission", "DriveMission"]
    mission: dict[str, Any]
    lease_s: float


class _Nothing(msgspec.Struct):
    """A request without arguments."""


_KINDS: dict[str, type[Mission]] = {kind.__name__: kind for kind in (MapMission, LocalizeMission, DriveMission)}
_ARGUMENTS: dict[str, type[msgspec.Struct]] = {
    "arm": _Nothing,
    "clear": _Nothing,
    "stop": NotedStop,
    "renew": NotedRenewal,
    "start": NotedStart,
    "use_map": NotedMap,
}


def check_noted(name: str, arguments: dict[str, Any]) -> None:
    """Refuse a request that cannot be repeated.

    Raises:
        RecordingError: there is no such request, or its arguments do not fit; says what was expected.
    """
    if name not in _ARGUMENTS:
        raise RecordingError(f"unknown request {name[:_QUOTED]!r}, expected one of {', '.join(_ARGUMENTS)}")
    noted = noted_as(_ARGUMENTS[name], name, arguments)
    if isinstance(noted, NotedStart):
        mission_of(noted)
    elif isinstance(noted, NotedMap):
        grid_of(noted)


def noted_as(kind: type[T], name: str, arguments: dict[str, Any]) -> T:
    """Return the arguments of a request.

    Raises:
        RecordingError: they are not what that request takes.
    """
    _require_finite(name, arguments)
    return _converted(kind, name, arguments)


def mission_of(start: NotedStart) -> Mission:
    """Return the mission that was started; RecordingError if that is none."""
    if not 0.0 < start.lease_s <= _LEASE_MAX_S:
        raise RecordingError(f"request 'start': expected a lease of 0 to {_LEASE_MAX_S:g} s, got {start.lease_s:g} s")
    return _converted(_KINDS[start.kind], "start", start.mission)


def grid_of(noted: NotedMap) -> OccupancyGrid:
    """Return the grid of a map that was taken into use.

    Raises:
        RecordingError: it is larger than a map can be, or its cells are not as many as its shape says. Never more
            memory is taken than that.
    """
    spec = noted.grid.spec
    try:
        return OccupancyGrid(spec, unpacked_cells(base64.b64decode(noted.grid.cells, validate=True), spec))
    except ValueError as error:
        raise RecordingError(f"request 'use_map': {error}") from error


def noted_grid(grid: OccupancyGrid) -> dict[str, Any]:
    """Return a grid as it is noted; for a large one that takes a second."""
    cells = base64.b64encode(packed_cells(grid.cells)).decode()
    return {"spec": msgspec.to_builtins(grid.spec), "cells": cells}


def _converted(kind: type[T], name: str, value: object) -> T:
    try:
        return msgspec.convert(value, kind)
    except (ValueError, TypeError, OverflowError, RecursionError) as error:
        raise RecordingError(f"request {name!r}: {str(error)[:_QUOTED]}") from error


def _require_finite(name: str, arguments: dict[str, Any]) -> None:
    try:
        json.dumps({key: value for key, value in arguments.items() if key != "grid"}, allow_nan=False)
    except (ValueError, TypeError, RecursionError) as error:
        raise RecordingError(f"request {name!r}: expected finite numbers and texts: {str(error)[:_QUOTED]}") from error
