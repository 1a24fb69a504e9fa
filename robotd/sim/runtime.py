"""An emulated robot on lines: pseudo-terminals for programs, memory for the same process."""

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable, Iterator
from pathlib import Path

from robotd.core.errors import TransportError
from robotd.core.together import ended
from robotd.hardware.transport.memory import memory_pair
from robotd.hardware.transport.pty import open_pty
from robotd.hardware.transport.transport import Connect, Transport
from robotd.sim.hosting.host import serve
from robotd.sim.hosting.pace import HostTime, SlowedTime, Time
from robotd.sim.robot import EmulatedRobot
from robotd.sim.truth_log import truth_log

Lines = dict[str, "asyncio.Queue[Transport]"]


async def run_on_ptys(
    robot: EmulatedRobot,
    *,
    announce: Callable[[dict[str, str]], None],
    directory: Path | None = None,
    truth_path: Path | None = None,
    say: Callable[[str], None] = lambda _: None,
) -> None:
    """Serve the boards on three pseudo-terminals until cancelled.

    Args:
        robot: the robot.
        announce: told the path to open for each device, once all are ready.
        directory: if given, links named after the devices are kept there, so that the paths are always the same.
        truth_path: if given, a JSON line ``{t_ns, x_m, y_m, heading_rad}`` is added whenever the robot comes to rest.
        say: told once that simulated time is slowed, when this process got no processor for a while.

    Raises:
        TransportError: the links cannot be made.
    """
    with contextlib.ExitStack() as stack:
        ptys = {device: stack.enter_context(contextlib.closing(open_pty())) for device in robot.boards}
        paths = {device: end.path for device, end in ptys.items()}
        if directory is not None:
            paths = stack.enter_context(_links(directory, paths))
        lines: Lines = {device: asyncio.Queue() for device in robot.boards}
        for device, end in ptys.items():
            lines[device].put_nowait(end)
        async with _served(robot, lines, SlowedTime(say), truth_path) as tasks:
            announce(paths)
            await asyncio.gather(*tasks)


@contextlib.asynccontextmanager
async def connectors(robot: EmulatedRobot, *, truth_path: Path | None = None) -> AsyncIterator[dict[str, Connect]]:
    """Serve the boards in memory and yield how to connect to each device.

    Each connection is a new line, which the board answers once the one before is closed. The boards live, and
    time passes for them, from here to the end of the block.
    """
    lines: Lines = {device: asyncio.Queue() for device in robot.boards}
    async with _served(robot, lines, HostTime(), truth_path):
        yield {device: _memory_connect(device, lines[device]) for device in robot.boards}


def _memory_connect(device: str, lines: "asyncio.Queue[Transport]") -> Connect:
    async def connect() -> Transport:
        near, far = memory_pair(device)
        lines.put_nowait(far)
        return near

    return connect


@contextlib.asynccontextmanager
async def _served(
    robot: EmulatedRobot, lines: Lines, time: Time, truth_path: Path | None
) -> AsyncIterator[tuple["asyncio.Task[None]", ...]]:
    with truth_log(robot, time, truth_path) if truth_path else contextlib.nullcontext() as log:
        note = log.note if log else _nothing
        tasks = tuple(
            asyncio.create_task(
                serve(board, robot.clocks[device], lines[device], on_step=note, time=time), name=f"board {device}"
            )
            for device, board in robot.boards.items()
        )
        tasks = (*tasks, asyncio.create_task(time.beat(), name="simulated time"))
        try:
            yield tasks
        finally:
            errors = await ended(tasks)
    for error in errors:
        raise error  # what a board raised must not be lost with its task


@contextlib.contextmanager
def _links(directory: Path, paths: dict[str, str]) -> Iterator[dict[str, str]]:
    """Keep links ``directory/device`` to the paths; links of an earlier run are replaced."""
    links = {device: directory / device for device in paths}
    try:
        try:
            directory.mkdir(parents=True, exist_ok=True)
            for device, link in links.items():
                if link.is_symlink():  # a file in its place is somebody's: the next line fails on it
                    link.unlink()
                link.symlink_to(paths[device])
        except OSError as error:
            raise TransportError(f"{directory}: cannot link the devices: {error.strerror}") from error
        yield {device: str(link) for device, link in links.items()}
    finally:
        for device, link in links.items():
            # Ours alone: another simulator may have taken the name since.
            if link.is_symlink() and str(link.readlink()) == paths[device]:
                link.unlink()


def _nothing() -> None:
    """Note nothing."""
