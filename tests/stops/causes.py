"""What ends a daemon; each is brought about at once, in the running program."""

import asyncio
import os
import signal
from collections.abc import Callable

from robotd.app.compose import Daemon

SIGNALS = (
    signal.SIGTERM,
    signal.SIGINT,
    signal.SIGHUP,
    signal.SIGQUIT,
    signal.SIGUSR1,
    signal.SIGUSR2,
    signal.SIGABRT,
)


class OurMistakeError(Exception):
    """What nobody foresaw."""


def _signal(number: signal.Signals) -> Callable[[Daemon], None]:
    return lambda _: os.kill(os.getpid(), number)


def _error_in(name: str) -> Callable[[Daemon], None]:
    def fail(_: Daemon) -> None:
        (task,) = [task for task in asyncio.all_tasks() if task.get_name() == name]
        coroutine = task.get_coro()
        _throw(task, OurMistakeError(f"in {coroutine}"))

    return fail


def _throw(task: "asyncio.Task[object]", error: Exception) -> None:
    """Let what a task waits for fail with an error of a kind that no task expects."""
    waited_for = task._fut_waiter  # type: ignore[attr-defined]  # asyncio's own, and its tests' way
    assert isinstance(waited_for, asyncio.Future)
    waited_for.set_exception(error)


CAUSES: dict[str, Callable[[Daemon], None]] = {
    **{number.name: _signal(number) for number in SIGNALS},
    **{f"error: {name}": _error_in(name) for name in ("drive", "pantilt", "rangefinder", "supervisor", "server")},
}
