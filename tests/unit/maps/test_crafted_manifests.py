"""Manifests with right sums that no store wrote."""

import json
from typing import Any

import pytest

from robotd.core.errors import MapError
from robotd.core.grid_spec import GridSpec
from robotd.maps.manifest import _MIGRATIONS, SCHEMA, FileSum, Manifest, _sum, decode_manifest

GOOD = Manifest("lab", 3, 17, "ab", GridSpec(0.05, 0.0, 0.0, (4, 5)), {"cells.bin": FileSum.of((b"cells",))}, {}, None)
SPEC = {"resolution_m": 0.05, "origin_x_m": 0.0, "origin_y_m": 0.0, "shape": [4, 5]}


def crafted(**changes: Any) -> bytes:
    content = json.loads(GOOD.encode()) | changes
    del content["sha256"]
    return summed(content)


def summed(content: dict[str, Any]) -> bytes:
    return json.dumps(content | {"sha256": _sum(content)}).encode()


def test_a_manifest_with_right_sums_is_read() -> None:
    assert decode_manifest(crafted()) == GOOD


def test_a_manifest_of_schema_1_says_that_its_stops_are_not_known() -> None:
    content = json.loads(GOOD.encode()) | {"schema": 1}
    del content["sha256"], content["stops"]
    assert decode_manifest(summed(content)) == GOOD
    with pytest.raises(MapError, match="schema 1 has no 'stops'"):
        decode_manifest(summed(content | {"stops": 3}))


@pytest.mark.parametrize("schema", [0, 3, -1, True, 1.0, 2.0, "2", None, [1], {"1": 2}, 10**30, "x" * 4000], ids=repr)
def test_other_schemas_are_refused_by_name(schema: Any) -> None:
    with pytest.raises(MapError, match=r"has schema .{1,20}, this version reads schemas 1 to 2"):
        decode_manifest(crafted(schema=schema))


def test_every_schema_leads_to_this_one() -> None:
    assert sorted(_MIGRATIONS) == list(range(1, SCHEMA))


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
        {"stops": -1},
        {"stops": "2"},
        {"stops": 1.5},
        {"stops": [2]},
    ],
    ids=str,
)
def test_what_no_store_wrote_is_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(MapError):
        decode_manifest(crafted(**changes))
