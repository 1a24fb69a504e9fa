"""Manifests with right sums that no store wrote."""

import json
from typing import Any

import pytest

from robotd.core.errors import MapError
from robotd.core.grid_spec import GridSpec
from robotd.maps.manifest import SCHEMA, FileSum, Manifest, _sum, decode_manifest

GOOD = Manifest("lab", 3, 17, "ab", GridSpec(0.05, 0.0, 0.0, (4, 5)), {"cells.bin": FileSum.of(b"cells")}, {})
SPEC = {"resolution_m": 0.05, "origin_x_m": 0.0, "origin_y_m": 0.0, "shape": [4, 5]}


def crafted(**changes: Any) -> bytes:
    content = json.loads(GOOD.encode()) | changes
    del content["sha256"]
    return json.dumps(content | {"schema": SCHEMA, "sha256": _sum({"schema": SCHEMA, **content})}).encode()


def test_a_manifest_with_right_sums_is_read() -> None:
    assert decode_manifest(crafted()) == GOOD


@pytest.mark.parametrize(
    "changes",
    [
        {"name": 5},
        {"name": "../lab"},
        {"version": "3"},
        {"created_unix_ns": None},
        {"created_unix_ns": 1.5},
        {"digest": 5},
        {"metadata": []},
        {"files": []},
        {"files": {"cells.bin": 5}},
        {"files": {"cells.bin": {"size_bytes": "5", "sha256": ""}}},
        {"files": {"cells.bin": {"size_bytes": -5, "sha256": ""}}},
        {"files": {"cells.bin": {"size_bytes": 2**40, "sha256": ""}}},
        {"files": {"cells.bin": {"size_bytes": 5, "sha256": None}}},
        {"spec": None},
        {"spec": SPEC | {"shape": 5}},
        {"spec": SPEC | {"shape": [4]}},
        {"spec": SPEC | {"shape": [4, 5, 6]}},
        {"spec": SPEC | {"shape": ["4", "5"]}},
        {"spec": SPEC | {"shape": [4.5, 5]}},
        {"spec": SPEC | {"shape": [10**30, 5]}},
        {"spec": SPEC | {"resolution_m": "0.05"}},
        {"spec": SPEC | {"resolution_m": 10**400}},
        {"spec": SPEC | {"origin_x_m": float("nan")}},
        {"more": 1},
    ],
    ids=str,
)
def test_what_no_store_wrote_is_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(MapError):
        decode_manifest(crafted(**changes))
