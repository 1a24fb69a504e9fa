"""Each call that makes or tells the status may fail: the robot is watched over all the same, and the next one comes."""

import asyncio
import errno
import logging
import os
from typing import Any

import pytest

from robotd.contract.events import Status
from robotd.contract.modes import Mode
from robotd.mission import supervisor as supervising
from tests.unit.mission.scripted_rig import Rig, rig

ERRORS = [
    *(OSError(number, os.strerror(number)) for number in (errno.EMFILE, errno.ENOSPC, errno.EACCES)),
    RuntimeError("a bug in the daemon"),
]


def failing(error: Exception) -> Any:
    def fail(*_: object, **__: object) -> None:
        raise error

    return fail


def break_call(call: str, r: Rig, error: Exception, broken: pytest.MonkeyPatch) -> None:
    """Let a call of what makes and tells the status fail."""
    match call:
        case "recording":
            broken.setattr(r.supervisor, "_recording", failing(error))
        case "publish":
            broken.setattr(r.supervisor.news, "publish", failing(error))
        case _:
            broken.setattr(supervising, call, failing(error))


@pytest.mark.parametrize("error", ERRORS, ids=repr)
@pytest.mark.parametrize("call", ["recording", "publish", "now_ns", "Status"])
async def test_no_error_of_a_call_ends_the_supervisor_and_it_is_said_once(
    call: str, error: Exception, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    async with rig(talking=False) as r:
        with monkeypatch.context() as broken:
            break_call(call, r, error, broken)
            await asyncio.sleep(5.0)
            assert not r.watching.done()
            # Other tests leave the log at another level, and that the mode changed is no error.
            assert len([record for record in caplog.records if record.levelno >= logging.ERROR]) == 1
        with r.supervisor.news.events.subscribe(100) as events:
            async with asyncio.timeout(3.5):
                for _ in range(3):
                    assert isinstance(await events.get(), Status)
        assert r.mode is Mode.IDLE


@pytest.mark.parametrize("error", ERRORS, ids=repr)
async def test_a_stop_is_carried_out_though_it_cannot_be_told(
    error: Exception, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    async with rig() as r:
        stops = [device.stops for device in r.devices]
        with monkeypatch.context() as broken, caplog.at_level(logging.ERROR):
            break_call("Status", r, error, broken)
            await r.supervisor.stop("a reason")
        assert [device.stops for device in r.devices] > stops
        assert r.mode is Mode.DISARMED
        assert not r.watching.done()
