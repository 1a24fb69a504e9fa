"""docs/api.md names everything that is in the code, and its programs run."""

import asyncio
import dataclasses
import os
import re
import subprocess
import sys
from collections.abc import Callable
from contextlib import AbstractAsyncContextManager
from enum import StrEnum
from pathlib import Path
from typing import Any

import msgspec
import pytest

from robotd.client import AsyncClient, Client
from robotd.contract.answers import ErrorCode, MapEntryInfo
from robotd.contract.arguments import PoseArgument
from robotd.contract.device_status import DeviceStatus, LinkState
from robotd.contract.estimate import Circle, Cover, Extent, PoseState, Region
from robotd.contract.events import MapChanged, MissionPhase
from robotd.contract.map_wire import MapPayload
from robotd.contract.missions import Legs
from robotd.contract.modes import MODE_WORDS
from robotd.contract.request import Request
from robotd.contract.requests import REQUESTS
from robotd.contract.topics import EVENTS, Topic
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.server.settings import ServerSettings

DOCS = Path(__file__).parents[3] / "docs"
TEXT = (DOCS / "api.md").read_text()


def section(title: str, level: int = 3) -> str:
    """The text under a heading, up to the next one of its level or above."""
    match = re.search(rf"(?ms)^{'#' * level} {re.escape(title)}$(.*?)(?=^#{{1,{level}}} |\Z)", TEXT)
    assert match is not None, f"no section {title}"
    return match[1]


def rows(text: str) -> dict[str, str]:
    """The rows of the tables in a text, by what is in backquotes in their first cell."""
    found = {}
    for line in text.splitlines():
        if line.startswith("| `"):
            found.update(dict.fromkeys(re.findall(r"`(\w+)`", line.split(" | ")[0]), line))
    return found


def names_of(kind: Any) -> set[str]:
    if dataclasses.is_dataclass(kind):
        return {field.name for field in dataclasses.fields(kind)}
    names: tuple[str, ...] = kind.__struct_fields__
    return set(names)


def test_every_command_stands_there_and_no_other() -> None:
    assert list(rows(section("Commands"))) == ["cmd", *REQUESTS]


@pytest.mark.parametrize("kind", REQUESTS.values(), ids=list(REQUESTS))
def test_every_argument_and_result_of_a_command_stands_there(kind: type[Request[Any]]) -> None:
    row = rows(section("Commands"))[kind.cmd]
    named = set(re.findall(r"`(\w+)`", row))
    assert names_of(kind) <= named
    if issubclass(kind.result, msgspec.Struct):
        assert names_of(kind.result) <= named


def test_every_error_stands_there_and_no_other() -> None:
    assert set(rows(section("Errors"))) == set(ErrorCode)


def test_every_topic_and_event_stands_there_and_no_other() -> None:
    table = [re.findall(r"`(\w+)`", line)[:2] for line in section("Topics").splitlines() if line.startswith("| `")]
    assert sorted(map(tuple, table)) == sorted((str(topic), name) for topic, name in EVENTS.values())
    assert {topic for topic, _ in table} == set(Topic)


@pytest.mark.parametrize(("kind", "name"), [(kind, name) for kind, (_, name) in EVENTS.items()])
def test_every_field_of_an_event_stands_there_and_no_other(kind: type[Any], name: str) -> None:
    own = section(f"`{name}`").partition("#### ")[0]
    assert set(rows(own)) == names_of(MapPayload if kind is MapChanged else kind)


def test_every_field_of_a_region_stands_in_its_table_and_no_other() -> None:
    assert set(rows(section("A region", level=4))) == names_of(Region)


PARTS = [Region, Extent, Circle, Cover, RangeReading, DeviceStatus, MapEntryInfo, PoseArgument]


@pytest.mark.parametrize("kind", PARTS)
def test_every_field_of_a_part_stands_there(kind: type[Any]) -> None:
    assert {name for name in names_of(kind) if f"`{name}`" not in TEXT.replace('"', "`")} == set()


@pytest.mark.parametrize("kind", [PoseState, MissionPhase, Legs, LinkState, ReadingStatus])
def test_every_value_of_an_enumeration_stands_there(kind: type[StrEnum]) -> None:
    assert [value for value in kind if f"`{value}`" not in TEXT] == []


def test_every_word_of_a_mode_stands_there() -> None:
    assert [word for word in MODE_WORDS if f"`{word}`" not in TEXT] == []


@pytest.mark.parametrize("client", [Client, AsyncClient])
def test_every_method_of_the_clients_stands_there(client: type[Any]) -> None:
    public = {name for name in dir(client) if not name.startswith("_")} - {
        "call",
        "ask",
        "ask_in_turn",
        "carry_out",
        "close",
    }
    public.add("frames")  # of the asynchronous client alone
    assert public == {name for name in re.findall(r"`(\w+)\(", section("From Python", level=2)) if name[0].islower()}


def test_the_limits_it_quotes_are_the_defaults() -> None:
    settings = ServerSettings()
    assert settings.max_request_bytes == 64 * 1024
    assert f"{settings.max_pending_requests} others" in TEXT
    assert f"{settings.state_queue} may wait for it, of maps {settings.map_queue}" in TEXT
    assert f"{settings.routine_hz:.0f} Hz" in TEXT
    assert f"configuration's {settings.lease_s} s" in TEXT


@pytest.mark.real_clock
async def test_the_example_client_localizes_from_another_process(
    serving: Callable[..., AbstractAsyncContextManager[Any]], tmp_path: Path
) -> None:
    printed = await run_program(serving, tmp_path, str(DOCS / "example_client.py"))
    assert "published: ambiguous at x 1.000 m, y 2.000 m, 280 of 300 readings explained" in printed
    assert "answer: localized at x 1.000 m, y 2.000 m, 280 of 300 readings explained" in printed


@pytest.mark.real_clock
async def test_the_program_on_the_page_runs(
    serving: Callable[..., AbstractAsyncContextManager[Any]], tmp_path: Path
) -> None:
    (program,) = re.findall(r"(?s)```python\n(.*?)```", TEXT)
    assert "localized at x 1.000 m" in await run_program(serving, tmp_path, "-c", program)


async def run_program(
    serving: Callable[..., AbstractAsyncContextManager[Any]], runtime_dir: Path, *arguments: str
) -> str:
    async with serving() as control:
        control.release.clear()
        program = await asyncio.create_subprocess_exec(
            sys.executable,
            *arguments,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env={**os.environ, "ROBOTD_RUNTIME_DIR": str(runtime_dir)},
        )
        await control.begun.wait()
        asyncio.get_running_loop().call_later(0.2, control.release.set)
        printed, errors = await asyncio.wait_for(program.communicate(), 20)
    assert (program.returncode, errors) == (0, b"")
    return printed.decode()
