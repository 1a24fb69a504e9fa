"""An emulated robot and the real daemon, as two processes joined by pseudo-terminals, with a client for this one."""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from robotd.cli.outputs import DEMO_MARK, write
from robotd.client import Client
from robotd.config import Config, effective_text
from robotd.contract.device_status import LinkState
from robotd.core.errors import RequestTimeout, RobotdError
from robotd.hardware.devices.settings import PortSettings, SilenceOptions
from robotd.mission.safety.hold import TOO_BUSY
from robotd.sim.hosting.pace import PATIENCE_S, SLOWED

UNFINISHED = "unfinished"
"""Name of the map of a demonstration that failed."""
FINISHED = b"finished\n"
"""What its mark says of a demonstration that came to its end; what others left is kept by the next."""
DEVICES = ("drive", "pantilt", "rangefinder")
_SILENT = re.compile(r"\b(silent for|no odometry for|no answer to|deadman)\b")
_START_S = 180.0
"""Starting is quick, unless the machine is busy with something else."""
_END_S = 60.0


P = TypeVar("P", bound=PortSettings)


@dataclass(frozen=True, slots=True)
class Rig:
    """What a demonstration plays with."""

    client: Client
    truth_file: Path


def wired(config: Config, directory: Path) -> Config:
    """Return a configuration whose devices, sockets, maps and recordings all live in a directory."""
    links = directory / "devices"
    return replace(
        config,
        sweep=replace(config.sweep, aim_timeout_s=PATIENCE_S),
        server=replace(config.server, runtime_dir=str(directory / "run")),
        drive=_patient(config.drive, links / "drive"),
        pantilt=_patient(config.pantilt, links / "pantilt"),
        rangefinder=_patient(config.rangefinder, links / "rangefinder"),
        maps=replace(config.maps, dir=str(directory / "maps")),
        recording=replace(config.recording, dir=str(directory / "recordings")),
    )


def _patient(device: P, link: Path) -> P:
    """Return a device's settings for a link, with patience where it is one that reports by itself."""
    patience: dict[str, Any] = {"silence_s": PATIENCE_S} if isinstance(device, SilenceOptions) else {}
    return replace(device, port=str(link), **patience)


@contextmanager
def rig(directory: Path, config: Config, emulator: list[str]) -> Iterator[Rig]:
    """Start both processes and yield once all three devices are there; end them afterwards, the daemon first.

    Args:
        directory: where everything lives; it exists.
        config: made by :func:`wired` for this directory.
        emulator: arguments of ``robotctl`` that run the emulated boards, without where to put them.

    Raises:
        RobotdError: one of them ended, or they did not find each other.
    """
    config_file, truth, log = (directory / name for name in ("robotd.toml", "truth.jsonl", "robotd.log"))
    config_file.write_text(effective_text(config), encoding="utf-8")
    links = directory / "devices"
    boards = [*_program("robotd.cli.main"), *emulator, "--links", str(links), "--truth", str(truth)]
    daemon = [*_program("robotd.app.daemon"), "--config", str(config_file)]
    with ExitStack() as stack:
        output = stack.enter_context(log.open("w", encoding="utf-8"))
        simulation = stack.enter_context(_running(boards, output.fileno()))
        _wait(lambda: all((links / name).exists() for name in DEVICES), "the emulated devices", simulation, log)
        process = stack.enter_context(_running(daemon, output.fileno()))
        client = stack.enter_context(Client(config.server.runtime_dir))
        _wait(lambda: _all_ready(client), "the daemon and its devices", process, log)
        try:
            yield Rig(client, truth)
        except RobotdError as error:
            why = explained(str(error), simulation.poll(), log.read_text(encoding="utf-8", errors="replace"))
            raise RobotdError(f"{why}; {_kept(client, directory)}; log: {log}; {_next_step(why)}") from error
        write(directory / DEMO_MARK, FINISHED)


def explained(reason: str, simulation_ended: int | None, log: str) -> str:
    """Return why a demonstration failed, with the machine as its cause where it must be.

    Args:
        reason: what the client was told.
        simulation_ended: exit code of the simulated robot; None while it lives.
        log: what both processes said.
    """
    if simulation_ended is not None:
        return f"{reason}: the simulated robot ended with {simulation_ended}"
    if TOO_BUSY not in reason and (SLOWED in log or _SILENT.search(reason)):  # no cable of it can come off
        return f"{reason}; {TOO_BUSY}: the simulated robot got no processor for a while"
    return reason


def _next_step(why: str) -> str:
    return "start it again when less else runs" if TOO_BUSY in why else "then start it again"


def _kept(client: Client, directory: Path) -> str:
    """Save what there is of a map, and say where it is: a demonstration that fails loses nothing."""
    try:
        entry = client.map_save(UNFINISHED)
    except RobotdError as error:
        return f"no map was saved ({error})"
    return f"the map so far: {directory / 'maps' / entry.name / str(entry.version)}"


def _program(module: str) -> list[str]:
    return [sys.executable, "-m", module]


@contextmanager
def _running(command: list[str], output: int) -> Iterator[subprocess.Popen[bytes]]:
    # A session of its own: Ctrl-C comes to us, we stop the robot, and only then end the processes.
    environment = os.environ | {"PYTHONUNBUFFERED": "1"}
    process = subprocess.Popen(command, stdout=output, stderr=output, start_new_session=True, env=environment)
    try:
        yield process
    finally:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(_END_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _wait(ready: Callable[[], bool], what: str, process: subprocess.Popen[bytes], log: Path) -> None:
    deadline_s = time.monotonic() + _START_S
    while not ready():
        if process.poll() is not None:
            raise RobotdError(f"{what}: the process ended with {process.returncode}; see {log}")
        if time.monotonic() > deadline_s:
            raise RobotdError(f"{what} did not come up in {_START_S:g} s; see {log}")
        time.sleep(0.05)


def _all_ready(client: Client) -> bool:
    with suppress(RequestTimeout):
        return all(device.link is LinkState.READY for device in client.status().devices)
    return False
