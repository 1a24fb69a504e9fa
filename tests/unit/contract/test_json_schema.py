"""The schema describes what goes over the wire: every golden message fits its own and refuses another's."""

import base64
import json
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from robotd.cli.main import main
from robotd.contract.json_schema import wire_schema
from robotd.contract.requests import REQUESTS
from robotd.contract.topics import EVENTS
from tests.unit.contract.messages import message, names

SCHEMA = wire_schema()


def as_json(value: Any) -> Any:
    """What JSON would hold: bytes as base64."""
    if isinstance(value, bytes):
        return base64.b64encode(value).decode()
    if isinstance(value, dict):
        return {key: as_json(item) for key, item in value.items()}
    return [as_json(item) for item in value] if isinstance(value, list) else value


def fits(kind: str, shown: Any) -> bool:
    of_kind = {**SCHEMA, "anyOf": [{"$ref": f"#/$defs/{kind}"}]}
    return bool(Draft202012Validator(of_kind).is_valid(as_json(shown)))


def test_it_is_a_schema_with_every_message_in_it() -> None:
    Draft202012Validator.check_schema(SCHEMA)
    messages = {name for name in SCHEMA["$defs"] if "." in name}
    requests = {f"{kind}.{name}" for name in REQUESTS for kind in ("request", "reply")}
    assert messages == requests | {f"event.{name}" for _, name in EVENTS.values()}


@pytest.mark.parametrize("name", names("exchanges"))
def test_golden_exchanges_fit(name: str) -> None:
    shown = message(f"exchanges/{name}")
    assert fits(f"request.{name}", shown["request"])
    assert fits(f"reply.{name}", shown["reply"])
    assert not fits(f"request.{name}", {**shown["request"], "cmd": "another"})
    assert not fits(f"request.{name}", {**shown["request"], "args": {"unheard_of": 1}})
    assert not fits(f"reply.{name}", {**shown["reply"], "result": 1})


@pytest.mark.parametrize("name", names("events"))
def test_golden_events_fit(name: str) -> None:
    shown = message(f"events/{name}")
    assert fits(f"event.{shown['event']}", shown)
    assert not fits(f"event.{shown['event']}", {**shown, "v": 2})
    assert not fits(f"event.{shown['event']}", {"v": 1, "session": "", "seq": 0, "event": shown["event"]})


def test_a_refusal_fits() -> None:
    assert fits("refusal", message("refusal"))


def test_the_command_line_prints_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["schema"]) == 0
    assert json.loads(capsys.readouterr().out) == json.loads(json.dumps(SCHEMA))
