"""The messages in ``golden/``, as other languages see them: maps, lists, numbers, texts and bytes."""

import json
from pathlib import Path
from typing import Any

import msgpack

from robotd.contract.envelope import NumberedRequest, decode_request
from robotd.contract.request import Request

GOLDEN = Path(__file__).parent / "golden"
LIMIT = 65536


def names(family: str) -> list[str]:
    """Return what there is of a family: ``exchanges`` by request, ``events`` by event."""
    return sorted(path.stem for path in (GOLDEN / family).iterdir())


def message(path: str) -> dict[str, Any]:
    """Return what is in a file; what is bytes stands there as ``{"hex": ...}``."""
    fields: dict[str, Any] = json.loads((GOLDEN / f"{path}.json").read_text(), object_hook=_or_bytes)
    return fields


def packed(fields: dict[str, Any]) -> bytes:
    """Return a message as it goes over the wire."""
    data: bytes = msgpack.packb(fields)
    return data


def golden_request(name: str) -> Request[Any]:
    """Return the example of a request."""
    numbered = decode_request(packed(message(f"exchanges/{name}")["request"]), LIMIT)
    assert isinstance(numbered, NumberedRequest)
    return numbered.request


def _or_bytes(fields: dict[str, Any]) -> Any:
    return bytes.fromhex(fields["hex"]) if list(fields) == ["hex"] else fields
