"""``sim`` and ``fake``: boards that are not there, on pseudo-terminals that are."""

import argparse
import asyncio
from collections.abc import Callable
from functools import partial
from pathlib import Path

from robotd.cli.terminal import err, print_json, print_pairs
from robotd.cli.verb import OK, Verb
from robotd.config.writer import write_value
from robotd.core.errors import RobotdError
from robotd.sim.robot import EmulatedRobot, SimulatedRobot
from robotd.sim.runtime import run_on_ptys
from robotd.sim.world import load_world, world_names

Announce = Callable[[dict[str, str]], None]


def _sim(arguments: argparse.Namespace) -> int:
    robot = _robot(arguments.world, arguments.seed)
    running = run_on_ptys(robot, announce=_announcer(arguments), directory=arguments.links, truth_path=arguments.truth)
    try:
        asyncio.run(running)
    except KeyboardInterrupt:
        return OK  # this is how it ends
    return OK


def _robot(world: str, seed: int) -> EmulatedRobot:
    return SimulatedRobot(load_world(world), seed)


def _announcer(arguments: argparse.Namespace) -> Announce:
    return partial(_announce, as_json=arguments.json, config_file=arguments.write_config)


def _announce(paths: dict[str, str], *, as_json: bool, config_file: Path | None) -> None:
    """Say where the devices are, and write a configuration that uses them."""
    if config_file is not None:
        _write_config(config_file, paths)
    if as_json:
        print_json({"devices": paths, "config": None if config_file is None else str(config_file)})
        return
    print_pairs(paths.items())
    if config_file is not None:
        err().print(f"now: robotd --config {config_file}", markup=False)
    err().print("Ctrl-C ends it", style="dim")


def _write_config(file: Path, paths: dict[str, str]) -> None:
    """Write a configuration for a robot on these lines, which keeps all that it makes beside itself."""
    text = "# Made by robotctl for emulated devices; what is not here has its default.\n"
    text += '[server]\nruntime_dir = "run"\n\n[maps]\ndir = "maps"\n\n[recording]\ndir = "recordings"\n'
    for device, path in paths.items():
        text += f"\n[{device}]\nport = {write_value(str(Path(path).absolute()))}\n"
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
    except OSError as error:
        raise RobotdError(f"cannot write {file}: {error.strerror}") from error


def _sim_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("world", metavar="WORLD", help=f"{', '.join(world_names())}, or the file of another")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="same seed, same noise (default: 1)")
    parser.add_argument("--truth", type=Path, metavar="FILE", help="note in it where the robot really came to rest")
    _lines_arguments(parser)


def _lines_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--links", type=Path, metavar="DIR", help="keep links drive, pantilt and rangefinder there")
    parser.add_argument("--write-config", type=Path, metavar="FILE", help="write a robotd.toml for these devices")


VERBS = (
    Verb(
        "sim",
        "simulate a robot in a room: three boards that speak the real protocol, on pseudo-terminals",
        "robotctl sim laboratory --write-config lab/robotd.toml",
        _sim,
        _sim_arguments,
    ),
)
