"""The program ``robotd``."""

import argparse
import asyncio
import logging
import os
import secrets
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import NoReturn

from robotd import __version__
from robotd.app.callbacks import stopping_on_errors
from robotd.app.compose import Daemon, compose, head_settings, serial_connectors
from robotd.app.daemon_lock import lock_directory
from robotd.app.ending import Ending
from robotd.app.first_map import load_first_map
from robotd.app.loop_lag import measure_lag
from robotd.app.stall_guard import guarded
from robotd.app.stalls import Stalls, keep_going
from robotd.app.watchdog import Notifier, feed_watchdog, watchdog_s
from robotd.children.child import Child
from robotd.children.resident import resident_bytes
from robotd.config import Config, default_path, effective_text, load
from robotd.contract.modes import Mode
from robotd.contract.requests import RecordStart, RecordStop, Stop
from robotd.core.clock import now_ns, run_counting, wall_offset_ns
from robotd.core.counted import Counted
from robotd.core.endpoints import Endpoints
from robotd.core.errors import ConfigError, RobotdError
from robotd.core.freed_memory import give_back_what_is_large
from robotd.core.garbage import looked_at_once
from robotd.core.log import LONGEST_LINE, configure
from robotd.core.text import printable
from robotd.front.heart_side import HeartSide
from robotd.front.supervised import front_of
from robotd.head.compute import ThreadCompute
from robotd.head.far import FarHead
from robotd.mission.counting import count_events
from robotd.recording.entries import CAUSES_ARE_NOTED, SILENCES_ARE_NOTED, RecordingHeader
from robotd.recording.preroll import PrerollJournal

EXIT_CONFIG = 78
"""EX_CONFIG of sysexits.h: the service manager does not try again, for that makes no file better."""
EXIT_INTERRUPTED = 130
"""What a shell says of a program that SIGINT ended."""

_ENDING = Stop("the daemon is ending")

log = logging.getLogger(__name__)


def main(argv: list[str] | None = None) -> int:
    """Run the daemon until a signal ends it; return the exit code."""
    arguments = build_parser().parse_args(argv)
    try:
        config = load(arguments.config or default_path())
    except ConfigError as error:
        # All of them: who mends a configuration line by line should not have to start the daemon for each.
        for problem in error.problems:
            print(printable(str(problem), LONGEST_LINE), file=sys.stderr)
        return EXIT_CONFIG
    configure(arguments.log_level)
    exit_code = 0
    try:
        # On a loop that counts its turns, for the journal notes how close together inputs came (decision 26).
        exit_code = run_counting(run(config))
    except* RobotdError as errors:  # foreseen, so they need no traceback; others end the program with theirs
        for one in _one_by_one(errors):
            log.error("%s", one)  # noqa: TRY400  # as above
        exit_code = 1
    except* KeyboardInterrupt:  # before there was anything to stop
        exit_code = EXIT_INTERRUPTED
    return exit_code


def program() -> NoReturn:
    """Run the daemon, and end without clearing up its memory: that takes a tenth of a second, and helps nobody."""
    code = main()
    logging.shutdown()
    sys.stdout.flush()
    os._exit(code)


def _one_by_one(errors: BaseExceptionGroup[RobotdError]) -> Iterator[RobotdError]:
    for error in errors.exceptions:
        if isinstance(error, BaseExceptionGroup):
            yield from _one_by_one(error)
        else:
            yield error


def build_parser() -> argparse.ArgumentParser:
    """Return what the program takes."""
    parser = argparse.ArgumentParser(
        prog="robotd",
        description="Own the robot's serial devices; map, localize, and serve poses over ZeroMQ.",
        epilog="A missing device is a state, not an error: the daemon waits for it. Ask it with: robotctl status",
    )
    parser.add_argument("--config", type=Path, metavar="FILE", help="configuration (default: /etc/robotd/robotd.toml)")
    parser.add_argument("--log-level", default="info", choices=("debug", "info", "warning", "error"))
    parser.add_argument("-V", "--version", action="version", version=f"robotd {__version__}")
    return parser


async def run(config: Config) -> int:
    """Serve until told to stop; return the exit code.

    Raises:
        RobotdError: as it is or in a group: another daemon serves here, the sockets cannot be had, or the recording is
            incomplete.
    """
    with ExitStack() as stack:
        # First of all: the one that has it is the only daemon here, and may open the lines.
        stack.enter_context(lock_directory(Endpoints(Path(config.server.runtime_dir)).runtime_dir))
        stack.enter_context(looked_at_once())
        give_back_what_is_large()
        journal = new_journal(config)
        disk = ThreadCompute()
        # Closed last of all but the lock: what ends after this may still have something for the disk.
        stack.callback(disk.close)
        head = FarHead.spawned(head_settings(config), logging.getLevelName(logging.root.level))
        daemon = compose(config, serial_connectors(config), head, disk, journal)
        # Only now: the head is told of before there is anybody who could be told that it is away.
        head.host = daemon.causes
        _show_gauges(daemon.supervisor.counted, head)
        # From here on a signal has something to stop; before, the default ends the program, which has opened
        # nothing yet.
        ending = Ending(partial(daemon.control.halt, _ENDING))
        # Longer than all the rest: the last map must be made into files.
        thinking = asyncio.create_task(head.run(), name="head")
        try:
            stalls = Stalls(daemon)
            with stopping_on_errors(partial(_halt, daemon)):
                # Round everything that moves the robot, and inside what keeps the last map, which may hold up
                # the loop at will.
                async with guarded(stalls.must_stop, daemon.robot.stop_past_loop, stalls.stalled):
                    await _serve(config, daemon, thinking, ending)
        except asyncio.CancelledError:
            if not ending.is_hastened:
                raise
        finally:
            try:
                await _keep_last(daemon)
            finally:
                if not thinking.cancelling():  # twice would hasten it, and leave its child to others
                    thinking.cancel()
                await asyncio.wait({thinking})
    return ending.exit_code


def _show_gauges(counted: Counted, head: FarHead) -> None:
    counted.show("compute_queue", lambda: float(head.waiting))
    counted.show("resident_bytes", resident_bytes, process="heart")
    counted.show("resident_bytes", lambda: resident_bytes(head.pid), process="head")


async def _keep_last(daemon: Daemon) -> None:
    try:
        await daemon.control.keeping.keep_last()
    finally:  # a disk that kept no map may still end a recording
        await daemon.control.perform(RecordStop())


def _halt(daemon: Daemon, reason: str) -> None:
    # Noted like any other stop, for a replay must say it, too; but once: a timer that fails may fail again and again.
    supervisor, stop = daemon.supervisor, Stop.because(reason)
    is_known = supervisor.mode is Mode.FAULT or (supervisor.mode, supervisor.reason) == (Mode.DISARMED, stop.reason)
    if not is_known:
        daemon.control.halt(stop)


async def _serve(config: Config, daemon: Daemon, thinking: "asyncio.Task[NoReturn]", ending: Ending) -> None:
    notifier = Notifier.of()
    side = HeartSide(daemon.control, config.server)
    front = front_of(side, partial(_without_clients, daemon, notifier), daemon.supervisor.counted)
    async with asyncio.TaskGroup() as group:
        serving = group.create_task(front.run(), name="front")
        if config.recording.from_start:
            # Before the devices run: a recording that began later would lack their handshakes.
            await daemon.control.perform(RecordStart())
        parts = {name: group.create_task(part, name=name) for name, part in daemon.parts().items()}
        keeping = group.create_task(daemon.control.keeping.run(), name="keep maps")
        going_on = group.create_task(keep_going(daemon, config.driving.silence_s), name="keep going")
        following = group.create_task(side.follow(), name="outcomes")
        headed = group.create_task(_as_long_as(thinking), name="head is well")
        counted = daemon.supervisor.counted
        lag = group.create_task(measure_lag(counted), name="measure lag")
        counting = group.create_task(count_events(daemon.control.events, counted), name="count events")
        tasks = [serving, following, *parts.values(), keeping, going_on, headed, lag, counting]
        for task in tasks:
            # A callback of the task itself: the group cancels the others first and looks at the error when they
            # have ended.
            task.add_done_callback(partial(_stop_if_failed, daemon))
        within_s = watchdog_s()
        if within_s is not None:
            feeding = feed_watchdog(notifier, within_s, lambda: not any(task.done() for task in tasks))
            tasks.append(group.create_task(feeding, name="watchdog"))
        tasks.append(group.create_task(_announce(front, notifier, config), name="announce"))
        loading = group.create_task(load_first_map(daemon, config.maps.load), name="first map")
        await ending.asked.wait()
        log.info("stopping: %s", ending.reason)
        notifier.stopping()
        # First the mission, then the clients, then the lines: who is served last could otherwise ask for motion
        # in between.
        await daemon.control.perform(_ENDING)
        if not daemon.control.keeping.is_needed:  # nobody waits for what is computed
            thinking.cancel()
        await _cancelled(serving, *(parts[device.name] for device in daemon.robot.devices))
        for task in (*tasks, loading):
            task.cancel()


async def _as_long_as(task: "asyncio.Task[NoReturn]") -> NoReturn:
    """End with an error of a task's, and without ending the task."""
    await asyncio.shield(task)


def _stop_if_failed(daemon: Daemon, task: "asyncio.Task[None]") -> None:
    """Stop before the others are told to end, which they do as they come."""
    error = None if task.cancelled() else task.exception()
    if error is not None:
        _halt(daemon, f"internal error: {error!r}")


async def _cancelled(*tasks: "asyncio.Task[None]") -> None:
    """Let nobody ask for anything more, and each device come to rest; who watches over it watches until then."""
    for task in tasks:
        task.cancel()
    await asyncio.wait(tasks)


async def _announce(front: Child, notifier: Notifier, config: Config) -> None:
    await front.is_ready.wait()
    notifier.ready()
    notifier.status("serving")
    places = (config.server.runtime_dir, config.maps.dir, config.recording.dir)
    log.info("robotd %s is ready: sockets in %s, maps in %s, recordings in %s", __version__, *places)


def _without_clients(daemon: Daemon, notifier: Notifier, why: str) -> None:
    """Go on, disarmed: the lines are ours, and it is tried again. The service manager has nothing to wait for."""
    _halt(daemon, why)
    notifier.ready()
    notifier.status(why)


def new_journal(config: Config) -> PrerollJournal:
    """Begin to remember."""
    header = RecordingHeader(
        robotd_version=__version__,
        config_text=effective_text(config),
        # Written into the header, so that a replay draws the same nonces; 63 bits, as JSON readers elsewhere
        # have signed numbers.
        session_seed=secrets.randbits(63),
        wall_offset_ns=wall_offset_ns(),
        started_ns=now_ns(),
    )
    journal = PrerollJournal(header, config.recording.preroll_bytes)
    journal.cause(header.started_ns, CAUSES_ARE_NOTED, {SILENCES_ARE_NOTED: True})
    return journal


if __name__ == "__main__":
    program()
