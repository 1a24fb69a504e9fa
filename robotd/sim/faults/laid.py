"""Cables laid to the boards of an emulated robot: in memory for a daemon in the same process, on pseudo-terminals."""

import asyncio
import contextlib
import random
from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

from robotd.core.errors import TransportError
from robotd.core.together import ended
from robotd.hardware.transport.pty import PtyEnd, open_pty
from robotd.sim.buildings.world import load_world
from robotd.sim.faults.cable import Cable
from robotd.sim.faults.plan import PlannedFault, carry_out
from robotd.sim.hosting.host import OwnBoard
from robotd.sim.robot import DEVICES, EmulatedRobot, SimulatedRobot
from robotd.sim.runtime import connectors

OnPlug = Callable[[str, bool], None]


@contextlib.asynccontextmanager
async def cables(
    robot: EmulatedRobot, *, truth_path: Path | None = None, on_plug: OnPlug = lambda *_: None
) -> AsyncIterator[dict[str, Cable]]:
    """Serve the boards of a robot, each at the end of a cable; give a daemon ``cable.connect`` of each.

    Who answers on a port where another device belongs is a board of a second robot.
    """
    async with connectors(robot, truth_path=truth_path) as boards, connectors(_second_robot()) as others:
        laid = {
            device: Cable(
                device,
                boards[device],
                stranger=others[_neighbour(device)],
                reboot=_reboot(robot, device),
                on_plug=lambda is_plugged, device=device: on_plug(device, is_plugged),  # type: ignore[misc]  # bound now
            )
            for device in robot.boards
        }
        tasks = [asyncio.create_task(cable.run(), name=f"cable of {device}") for device, cable in laid.items()]
        try:
            yield laid
        finally:
            errors = await ended(tasks)
        for error in errors:
            raise error


async def run_faulty_on_ptys(
    robot: EmulatedRobot,
    plan: tuple[PlannedFault, ...],
    *,
    seed: int,
    announce: Callable[[dict[str, str]], None],
    say: Callable[[str], None],
    directory: Path | None = None,
    truth_path: Path | None = None,
) -> None:
    """Serve the boards on pseudo-terminals until cancelled, and let go wrong what is planned.

    Raises:
        TransportError: the links cannot be made.
        ConfigError: a board cannot do what the plan asks of it.
    """
    async with cables_on_ptys(robot, directory, truth_path=truth_path) as (laid, links):
        announce(links)
        await carry_out(plan, laid, seed, say)
        await asyncio.get_running_loop().create_future()


@contextlib.asynccontextmanager
async def cables_on_ptys(
    robot: EmulatedRobot, directory: Path | None = None, *, truth_path: Path | None = None
) -> AsyncIterator[tuple[dict[str, Cable], dict[str, str]]]:
    """Serve the boards on pseudo-terminals, each at the end of a cable; yield the cables, and what to open.

    The devices are reached by links, in ``directory`` or in one made for them, which come and go with the plugs, as the
    names under ``/dev/serial/by-id`` do.

    Raises:
        TransportError: the links cannot be made.
    """
    with contextlib.ExitStack() as stack:
        home = directory or Path(stack.enter_context(TemporaryDirectory(prefix="robotd-sim-")))
        links, paths = stack.enter_context(_links(home)), dict[str, str]()

        def on_plug(device: str, is_plugged: bool) -> None:
            _unlink(links[device])
            if is_plugged:
                end = _pty_not_called(paths.get(device))
                laid[device].put(end)
                paths[device] = end.path
                _link(links[device], end.path)

        async with cables(robot, truth_path=truth_path, on_plug=on_plug) as laid:
            for device in laid:
                on_plug(device, True)
            yield laid, {device: str(link) for device, link in links.items()}


@contextlib.contextmanager
def _links(directory: Path) -> Iterator[Mapping[str, Path]]:
    links = {device: directory / device for device in DEVICES}
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise TransportError(f"{directory}: cannot link the devices: {error.strerror}") from error
    try:
        yield links
    finally:
        for link in links.values():
            _unlink(link)


def _pty_not_called(path: str | None) -> PtyEnd:
    end = open_pty()
    if end.path != path:
        return end
    with contextlib.closing(end):  # while it is open, the next is called otherwise
        return open_pty()


def _link(link: Path, path: str) -> None:
    try:
        link.symlink_to(path)
    except OSError as error:
        raise TransportError(f"{link}: cannot link the device: {error.strerror}") from error


def _unlink(link: Path) -> None:
    if link.is_symlink():  # what is no link is not ours
        link.unlink()


def _second_robot() -> SimulatedRobot:
    # A robot of its own: a stranger that is armed must not drive the first one's body.
    return SimulatedRobot(load_world("office"), seed=0)


def _neighbour(device: str) -> str:
    return DEVICES[(DEVICES.index(device) + 1) % len(DEVICES)]  # of another kind: that is what a handshake can tell


def _reboot(robot: EmulatedRobot, device: str) -> Callable[[], None] | None:
    board = robot.boards[device]
    if not isinstance(board, OwnBoard):
        return None
    boot_ids = random.Random(f"{device}/reboots")  # each boot has another, each run the same
    return lambda: board.reboot(boot_ids.getrandbits(32))
