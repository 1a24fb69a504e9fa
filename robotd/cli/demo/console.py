"""A simulated robot, the real daemon and the console for a browser: an address, ready to be clicked."""

import argparse
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from robotd.cli.demo.rig import rig, wired
from robotd.cli.demo.room import brisk, fresh
from robotd.cli.exit_codes import OK
from robotd.cli.show.terminal import bold, err, out, print_json
from robotd.config import Config
from robotd.core.errors import RobotdError
from robotd.gateway.access.roles import Role
from robotd.gateway.access.tokens import TokenFile, Tokens, make_token
from robotd.gateway.settings import AccessSettings, GatewaySettings, ListenSettings, RobotSettings
from robotd.sim.buildings.world import load_world
from robotd.toml.writer import write_table

_START_S = 60.0
_END_S = 10.0
_SERVES = "the console is at "


def run(arguments: argparse.Namespace) -> int:
    """Serve until Ctrl-C, and return the exit code."""
    _require_console()
    load_world(arguments.world)  # a name that is none is found out before anything starts
    directory = fresh(arguments.out)
    settings = _settings(directory, arguments.world, arguments.port)
    secret, token = make_token("you", Role.ADMIN, time.time(), is_for_one_use=True)
    TokenFile(settings.access.tokens).write(Tokens((token,)))
    emulator = ["sim", arguments.world, "--seed", str(arguments.seed)]
    if not arguments.json:
        out().print(
            bold("robotd console") + f": starting a robot in the {arguments.world}; all it makes is in {directory}"
        )
    with rig(directory, wired(Config(driving=brisk()), directory), emulator), _gateway(directory, settings) as address:
        if arguments.json:
            print_json({"address": f"{address}#{secret}", "directory": str(directory)})
        else:
            out().print("Open this address in a browser; it signs in once. Ctrl-C ends robot and console.\n")
            out().print(f"  {address}#{secret}\n", markup=False, soft_wrap=True)
        sys.stdout.flush()  # who reads through a pipe waits for the address
        with suppress(KeyboardInterrupt):  # which is how it ends
            signal.pause()
    return OK


def _require_console() -> None:
    """Build the console if it is not there.

    Raises:
        RobotdError: it cannot be, or what serves it is not installed.
    """
    from robotd.gateway.web.bundle import build, is_fresh  # noqa: PLC0415  # only a clone has to

    try:
        if not is_fresh():
            err().print("building the console (once)")
            build()
    except (OSError, subprocess.CalledProcessError) as error:
        raise RobotdError(f"the console cannot be built: {error}") from error


def _settings(directory: Path, robot: str, port: int) -> GatewaySettings:
    return GatewaySettings(
        listen=ListenSettings(port=port),
        robot=RobotSettings(Path(robot).stem, str(directory / "run"), str(directory / "recordings")),
        access=AccessSettings(state_dir=str(directory / "gateway")),
    )


@contextmanager
def _gateway(directory: Path, settings: GatewaySettings) -> Iterator[str]:
    """Start the gateway, and yield the address it serves at.

    Raises:
        RobotdError: it ended, or did not come up.
    """
    file, log = directory / "robotd-gateway.toml", directory / "robotd-gateway.log"
    file.write_text(write_table(settings), encoding="utf-8")
    command = [sys.executable, "-m", "robotd.gateway.program", "--config", str(file)]
    with log.open("wb") as output:
        # A session of its own: Ctrl-C comes to us, and we end it.
        process = subprocess.Popen(
            command, stdout=output, stderr=output, start_new_session=True, env=os.environ | {"PYTHONUNBUFFERED": "1"}
        )
    try:
        yield _address(process, log)
    finally:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(_END_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _address(process: "subprocess.Popen[bytes]", log: Path) -> str:
    deadline_s = time.monotonic() + _START_S
    while time.monotonic() < deadline_s:
        said = log.read_text(encoding="utf-8", errors="replace")
        if _SERVES in said:
            return said.partition(_SERVES)[2].split()[0]
        if process.poll() is not None:
            why = next((line for line in said.splitlines() if line.startswith("robotd-gateway: ")), f"see {log}")
            raise RobotdError(why)
        time.sleep(0.05)
    raise RobotdError(f"the gateway did not come up in {_START_S:g} s; see {log}")
