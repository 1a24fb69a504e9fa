"""Each call that carries a line of the log to clients may fail: the loop is not troubled, and the next line comes."""

import asyncio
import errno
import logging
import os
from typing import Any

import pytest

from robotd.contract.topics import LogEntry
from robotd.front import log_relay
from robotd.front.log_relay import relay_log

ERRORS = [
    *(OSError(number, os.strerror(number)) for number in (errno.EMFILE, errno.ENOSPC, errno.EACCES)),
    RuntimeError("a bug in the daemon"),
]
log = logging.getLogger("robotd.mission")


class Clients:
    """Take lines, unless they are told to fail."""

    def __init__(self) -> None:
        self.lines: list[LogEntry] = []
        self.error: Exception | None = None

    def take(self, line: LogEntry) -> None:
        if self.error is not None:
            raise self.error
        self.lines.append(line)


def failing(error: Exception) -> Any:
    def fail(*_: object, **__: object) -> None:
        raise error

    return fail


@pytest.mark.parametrize("error", ERRORS, ids=repr)
@pytest.mark.parametrize("call", ["deliver", "now_ns", "printable_lines", "call_soon_threadsafe"])
async def test_no_error_of_a_call_troubles_the_loop_and_it_is_said_once(
    call: str, error: Exception, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    loop = asyncio.get_running_loop()
    troubles: list[object] = []
    loop.set_exception_handler(lambda _, context: troubles.append(context))
    clients = Clients()
    with monkeypatch.context() as broken, caplog.at_level(logging.INFO), relay_log(clients.take):
        clients.error = error if call == "deliver" else None
        if call == "call_soon_threadsafe":
            broken.setattr(loop, call, failing(error))
        elif call != "deliver":
            broken.setattr(log_relay, call, failing(error))
        for _ in range(3):
            log.info("a bumper was hit")
            await asyncio.sleep(0)
        assert clients.lines == []
        broken.undo()
        clients.error = None
        log.info("a bumper was hit again")
        await asyncio.sleep(0)
    assert [line.message for line in clients.lines] == ["a bumper was hit again"]
    assert troubles == []
    complaints = [record.getMessage() for record in caplog.records if record.name == log_relay.__name__]
    assert complaints == [f"a line of robotd.mission did not reach the clients: {error!r}"]


async def test_a_failure_that_comes_again_is_said_again(caplog: pytest.LogCaptureFixture) -> None:
    clients = Clients()
    with relay_log(clients.take):
        for clients.error in (ERRORS[0], None, ERRORS[1]):
            log.error("a bumper was hit")
            await asyncio.sleep(0)
    complaints = [record for record in caplog.records if record.name == log_relay.__name__]
    assert (len(clients.lines), len(complaints)) == (1, 2)
