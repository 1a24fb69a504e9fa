"""Requests read back from a recording: whatever does not fit is refused by name, and takes no memory."""

import base64
import tracemalloc
import zlib
from typing import Any

import pytest

from robotd.core.errors import RecordingError
from robotd.mission.noted import check_noted

_MIB = 2**20
_SPEC = {"resolution_m": 0.05, "origin_x_m": 0.0, "origin_y_m": 0.0, "shape": [4, 5]}


def used(cells: bytes = bytes(20), **changes: Any) -> dict[str, Any]:
    packed = {"spec": _SPEC, "cells": base64.b64encode(zlib.compress(cells)).decode()}
    return {"map_id": "a", "name": "a", "grid": packed, "robot_in_map": None} | changes


def placed(**changes: Any) -> dict[str, Any]:
    arguments = used()
    arguments["grid"]["spec"] = _SPEC | changes
    return arguments


def started(mission: Any = None, kind: Any = "DriveMission", lease_s: Any = 1.0) -> dict[str, Any]:
    return {"kind": kind, "mission": {"x_m": 1.0, "y_m": 2.0} if mission is None else mission, "lease_s": lease_s}


def nested(depth: int) -> list[Any]:
    value: list[Any] = []
    for _ in range(depth):
        value = [value]
    return value


GOOD = [("arm", {}), ("clear", {}), ("stop", {"reason": "x"}), ("renew", {"mission_id": 1}), ("start", started())]
BAD = [
    ("dance", {}),
    ("", {}),
    ("stop", {}),
    ("stop", {"reason": 5}),
    ("stop", {"reason": None}),
    ("renew", {}),
    ("renew", {"mission_id": "1"}),
    ("renew", {"mission_id": 1.5}),
    ("start", {}),
    ("start", started(kind="ArmMission")),
    ("start", started(kind=None)),
    ("start", started(kind=["DriveMission"])),
    ("start", started({})),
    ("start", started({"x_m": "far", "y_m": 0.0})),
    ("start", started({"x_m": float("nan"), "y_m": 0.0})),
    ("start", started([])),
    ("start", started(lease_s=-1.0)),
    ("start", started(lease_s=float("inf"))),
    ("start", started(lease_s=10**400)),
    ("start", started(nested(100_000))),
    ("use_map", {}),
    ("use_map", used(grid=None)),
    ("use_map", used(grid={"spec": _SPEC})),
    ("use_map", used(grid={"spec": _SPEC, "cells": "not base64!"})),
    ("use_map", used(grid={"spec": _SPEC, "cells": base64.b64encode(b"not zlib").decode()})),
    ("use_map", used(grid={"spec": _SPEC, "cells": 5})),
    ("use_map", used(bytes(19))),
    ("use_map", used(bytes(21))),
    ("use_map", used(map_id=5)),
    ("use_map", used(robot_in_map={"x_m": 1.0})),
    ("use_map", used(robot_in_map=[1, 2, 3])),
    ("use_map", placed(shape=[4])),
    ("use_map", placed(shape=[0, 5])),
    ("use_map", placed(shape=[-4, -5])),
    ("use_map", placed(shape=["4", "5"])),
    ("use_map", placed(shape=[10**30, 5])),
    ("use_map", placed(shape=[8193, 1])),
    ("use_map", placed(resolution_m=0.0)),
    ("use_map", placed(resolution_m=10**400)),
]


@pytest.mark.parametrize(("name", "arguments"), [*GOOD, ("use_map", used())])
def test_what_the_journal_notes_is_taken(name: str, arguments: dict[str, Any]) -> None:
    check_noted(name, arguments)


@pytest.mark.parametrize(("name", "arguments"), BAD, ids=range(len(BAD)))
def test_what_no_journal_notes_is_refused_by_name(name: str, arguments: dict[str, Any]) -> None:
    with pytest.raises(RecordingError, match=f"{name!r}"):
        check_noted(name, arguments)


def test_a_bomb_takes_no_more_memory_than_the_map_that_it_claims_to_be() -> None:
    squeezing = zlib.compressobj(9)
    bomb = b"".join(squeezing.compress(bytes(_MIB)) for _ in range(64)) + squeezing.flush()
    grid = {"spec": _SPEC, "cells": base64.b64encode(bomb).decode()}
    tracemalloc.start()
    try:
        with pytest.raises(RecordingError, match="expected 20 bytes of cells"):
            check_noted("use_map", used(grid=grid))
        assert tracemalloc.get_traced_memory()[1] < _MIB
    finally:
        tracemalloc.stop()
