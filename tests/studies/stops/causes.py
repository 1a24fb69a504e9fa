"""What ends a daemon, or stops the robot of one that lives on; each comes at once, in the running program."""

import asyncio
import os
import signal
from collections.abc import Callable

from robotd.app.compose import Daemon
from robotd.contract.requests import Stop
from tests.studies.stops.rig import Rig

Cause = Callable[[Rig, Daemon], None]

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


def _signal(number: signal.Signals) -> Cause:
    return lambda *_: os.kill(os.getpid(), number)


def _error_in(name: str) -> Cause:
    def fail(*_: object) -> None:
        (task,) = [task for task in asyncio.all_tasks() if task.get_name() == name]
        _throw(task, OurMistakeError(f"in {name}"))

    return fail


def _throw(task: "asyncio.Task[object]", error: Exception) -> None:
    """Let what a task waits for fail with an error of a kind that no task expects."""
    waited_for = task._fut_waiter  # type: ignore[attr-defined]  # asyncio's own, and its tests' way
    assert isinstance(waited_for, asyncio.Future)
    waited_for.set_exception(error)


def _stop(rig: Rig, daemon: Daemon) -> None:
    rig.tasks.append(asyncio.create_task(daemon.control.perform(Stop("enough"))))


def _lease_ends(_: Rig, daemon: Daemon) -> None:
    mission = daemon.supervisor.mission
    if mission.mission_id is not None:
        mission.lease_expired(mission.mission_id)


def _head_lost(rig: Rig, _: Daemon) -> None:
    rig.wires[HEAD].cut()


HEAD = "pantilt"
ENDINGS: dict[str, Cause] = {
    **{number.name: _signal(number) for number in SIGNALS},
    **{f"error: {name}": _error_in(name) for name in ("drive", "pantilt", "rangefinder", "supervisor", "front")},
}
"""After these the daemon ends."""
HEAD_LOST = "head lost"
CAUSES: dict[str, Cause] = ENDINGS | {"stop": _stop, "lease": _lease_ends, HEAD_LOST: _head_lost}
