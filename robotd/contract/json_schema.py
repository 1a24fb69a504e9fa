"""The whole wire as one JSON Schema (draft 2020-12), made from the types: for generators, validators, other languages.

Messages are msgpack, so ``bytes`` (cells of a map) travel as such; in the schema, as in JSON, they are base64 text.
"""

from collections.abc import Iterable
from typing import Any

import msgspec

from robotd.contract.answers import ErrorCode
from robotd.contract.envelope import LONGEST_CLIENT
from robotd.contract.events import MapChanged
from robotd.contract.map_wire import MapPayload
from robotd.contract.plain import VERSION
from robotd.contract.requests import REQUESTS
from robotd.contract.topics import EVENTS

DIALECT = "https://json-schema.org/draft/2020-12/schema"
_ID = {"type": "integer", "minimum": 0, "maximum": 2**63 - 1}
_VERSION = {"const": VERSION}
_CLIENT = {"type": "string", "maxLength": LONGEST_CLIENT}


def wire_schema() -> dict[str, Any]:
    """Return the schema of a message of any kind; ``$defs`` has each by its name.

    ``request.NAME``, ``reply.NAME`` and ``event.NAME``, as :data:`.REQUESTS` and :data:`.EVENTS` name them, and
    ``refusal``. What a reply or an event has beyond its schema is of a later version, and to be ignored.
    """
    kinds = [*REQUESTS.values(), *(_on_the_wire(kind) for kind in (*_results(), *EVENTS))]
    told, parts = msgspec.json.schema_components(kinds, ref_template="#/$defs/{name}")
    schemas = dict(zip(kinds, told, strict=True))
    messages: dict[str, Any] = {"refusal": _refusal()}
    for name, request in REQUESTS.items():
        messages[f"request.{name}"] = _request(name, schemas[request])
        messages[f"reply.{name}"] = _reply(schemas[_on_the_wire(request.result)])
    for event, (topic, name) in EVENTS.items():
        messages[f"event.{name}"] = _event(topic, name, schemas[_on_the_wire(event)])
    return {
        "$schema": DIALECT,
        "title": f"robotd, wire version {VERSION}",
        "anyOf": [{"$ref": f"#/$defs/{name}"} for name in messages],
        "$defs": {**messages, **parts},
    }


def _results() -> Iterable[Any]:
    # A result may answer several requests, and is described once.
    return dict.fromkeys(request.result for request in REQUESTS.values())


def _on_the_wire(kind: Any) -> Any:
    """Return the type that stands for another on the wire: cells are sent packed."""
    return MapPayload if kind is MapChanged else kind


def _request(name: str, arguments: dict[str, Any]) -> dict[str, Any]:
    fields = {"v": _VERSION, "id": _ID, "cmd": {"const": name}, "args": arguments, "client": _CLIENT}
    # Requests alone are closed: what the daemon does not know it refuses.
    return {"type": "object", "properties": fields, "required": ["v", "id", "cmd"], "additionalProperties": False}


def _reply(result: dict[str, Any]) -> dict[str, Any]:
    fields = {"v": _VERSION, "id": _ID, "ok": {"const": True}, "result": result}
    return {"type": "object", "properties": fields, "required": list(fields)}


def _refusal() -> dict[str, Any]:
    code = {"enum": [str(code) for code in ErrorCode]}
    error = {
        "type": "object",
        "properties": {"code": code, "message": {"type": "string"}},
        "required": ["code", "message"],
    }
    fields = {"v": _VERSION, "id": {"anyOf": [_ID, {"type": "null"}]}, "ok": {"const": False}, "error": error}
    return {"type": "object", "properties": fields, "required": list(fields)}


def _event(topic: str, name: str, fields: dict[str, Any]) -> dict[str, Any]:
    envelope = {
        "v": _VERSION,
        "session": {"type": "string"},
        "seq": {"type": "integer", "minimum": 0},
        "event": {"const": name},
    }
    return {
        "description": f"published on the topic {topic}",
        "allOf": [{"type": "object", "properties": envelope, "required": list(envelope)}, fields],
    }
