"""Requests as the journal notes them, and read back: what does not fit is refused, no map takes more than its size."""

import base64
import json
from typing import Any, TypeVar

import msgspec

from robotd.contract.missions import MISSIONS, Mission, MissionRequest, with_lease
from robotd.contract.request import Request
from robotd.contract.requests import REQUESTS
from robotd.contract.ways import Point
from robotd.core.errors import RecordingError
from robotd.core.grid_bytes import unpacked_cells
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import Pose2
from robotd.exploring.errand import Errand
from robotd.grid.settings import GridSettings
from robotd.head.jobs import HeldMap

_LEASE_MAX_S = 1e9
"""Far above what a client may ask for (``LeaseTime`` of the contract); beyond it is what no daemon noted."""
_QUOTED = 80
"""This many characters of what was wrong are told."""

T = TypeVar("T")


class NotedMap(msgspec.Struct):
    """A map that was taken into use."""

    map_id: str
    name: str
    grid: "_PackedGrid"
    robot_in_map: Pose2 | None
    bumps_m: tuple[Point, ...] = ()
    """Where the robot bumped into something on it before."""
    exploring: Errand | None = None
    """How far exploring it has come."""


class _PackedGrid(msgspec.Struct):
    spec: GridSpec
    cells: str
    """Base64 of the packed cells."""
    settings: GridSettings = GridSettings()
    """How further readings change it, which the planner goes by, too: recordings of before lack it, and were replayed
    by this."""
    stops: str | None = None
    """Base64 of its packed stops, if it came with any: what goes on with it places sweeps on them."""


class _NotedStart(msgspec.Struct):
    kind: str
    mission: dict[str, Any]
    lease_s: float


_START, _USE_MAP = "start", "use_map"
_MISSIONS = {kind.noted: kind for kind in MISSIONS}
_REQUESTS = {kind.cmd: kind for kind in REQUESTS.values() if kind.is_noted and kind not in MISSIONS}
_NAMES = (*_REQUESTS, _START, _USE_MAP)


def noted(request: Request[Any]) -> tuple[str, dict[str, Any]]:
    """Return the name and the arguments that a request is noted by."""
    if isinstance(request, MissionRequest):
        fields = msgspec.to_builtins(request)
        # Recordings have the lease beside the mission, requests have it within: the format of recordings stays.
        return _START, {"kind": request.noted, "mission": fields, "lease_s": fields.pop("lease_s")}
    return request.cmd, msgspec.to_builtins(request)


def request_of(name: str, arguments: dict[str, Any]) -> "Request[Any] | NotedMap":
    """Return a request that was noted.

    Raises:
        RecordingError: there is no such request, or its arguments do not fit; says what was expected.
    """
    # By a list of what was ever noted, not of all commands: a recording that asks for others was made by other
    # hands.
    if name not in _NAMES:
        raise RecordingError(f"unknown request {name[:_QUOTED]!r}, expected one of {', '.join(_NAMES)}")
    _require_finite(name, arguments)
    if name == _USE_MAP:
        return _converted(NotedMap, name, arguments)
    if name == _START:
        return _mission_of(_converted(_NotedStart, name, arguments))
    kind = _REQUESTS[name]
    if missing := [field for field in kind.__struct_fields__ if field not in arguments]:  # what is noted is whole
        raise RecordingError(f"request {name!r}: expected {', '.join(missing)}")
    return _converted(kind, name, arguments)


def check_noted(name: str, arguments: dict[str, Any]) -> None:
    """Refuse a request that cannot be repeated.

    Raises:
        RecordingError: there is no such request, or its arguments do not fit; says what was expected.
    """
    request = request_of(name, arguments)
    if isinstance(request, NotedMap):
        packed_of(request)
        stops_of(request)


def _mission_of(start: _NotedStart) -> Mission:
    if not 0.0 < start.lease_s <= _LEASE_MAX_S:
        raise RecordingError(f"request 'start': expected a lease of 0 to {_LEASE_MAX_S:g} s, got {start.lease_s:g} s")
    if start.kind not in _MISSIONS:
        kinds = ", ".join(_MISSIONS)
        raise RecordingError(f"request 'start': expected one of {kinds}, got {start.kind[:_QUOTED]!r}")
    return with_lease(_converted(_MISSIONS[start.kind], _START, start.mission), start.lease_s)


def packed_of(noted: NotedMap) -> bytes:
    """Return the packed cells of a map that was taken into use.

    Raises:
        RecordingError: it is larger than a map can be, or its cells are not as many as its shape says. Never more
            memory is taken than that.
    """
    try:
        packed = base64.b64decode(noted.grid.cells, validate=True)
        unpacked_cells(packed, noted.grid.spec)
    except ValueError as error:
        raise RecordingError(f"request 'use_map': {error}") from error
    return packed


def stops_of(noted: NotedMap) -> bytes | None:
    """Return the packed stops of a map that was taken into use, None if it came without.

    Raises:
        RecordingError: they are no text of bytes.
    """
    if noted.grid.stops is None:
        return None
    try:
        return base64.b64decode(noted.grid.stops, validate=True)
    except ValueError as error:
        raise RecordingError(f"request 'use_map': {error}") from error


def noted_grid(held: HeldMap, stops: bytes | None) -> dict[str, Any]:
    """Return the grid of a map, and its packed stops, as they are noted."""
    cells, settings = base64.b64encode(held.packed).decode(), msgspec.to_builtins(held.settings)
    grid = {"spec": msgspec.to_builtins(held.spec), "cells": cells, "settings": settings}
    return grid if stops is None else grid | {"stops": base64.b64encode(stops).decode()}


def _converted(kind: type[T], name: str, value: object) -> T:
    try:
        return msgspec.convert(value, kind)
    except (ValueError, TypeError, OverflowError, RecursionError) as error:
        raise RecordingError(f"request {name!r}: {str(error)[:_QUOTED]}") from error


def _require_finite(name: str, arguments: dict[str, Any]) -> None:
    try:
        # JSON as Python reads it has NaN and Infinity. The grid is left out: it may have megabytes, and GridSpec
        # looks at its own numbers.
        json.dumps({key: value for key, value in arguments.items() if key != "grid"}, allow_nan=False)
    except (ValueError, TypeError, RecursionError) as error:
        raise RecordingError(f"request {name!r}: expected finite numbers and texts: {str(error)[:_QUOTED]}") from error
