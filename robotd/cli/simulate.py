"""``sim`` and ``fake``: boards that are not there, on pseudo-terminals that are."""

import argparse
import asyncio
from collections.abc import Coroutine
from pathlib import Path
from typing import Any

from robotd.cli.emulated import GridSize, grid_size, write_config
from robotd.cli.terminal import err, print_json, print_pairs
from robotd.cli.verb import OK, Verb
from robotd.sim.load import load_robot
from robotd.sim.recorded_building import OdometrySource
from robotd.sim.robot import EmulatedRobot
from robotd.sim.runtime import run_on_ptys
from robotd.sim.world import world_names


def _sim(arguments: argparse.Namespace) -> int:
    robot = robot_of(arguments)
    size = grid_size(arguments.world, robot) if arguments.write_config else None
    return _until_interrupted(
        run_on_ptys(
            robot,
            announce=lambda ports: _announce(arguments, ports, size),
            directory=_absolute(arguments.links),
            truth_path=arguments.truth,
        )
    )


def _until_interrupted(running: Coroutine[Any, Any, None]) -> int:
    try:
        asyncio.run(running)
    except KeyboardInterrupt:
        return OK  # that is how it ends
    return OK


def _absolute(path: Path | None) -> Path | None:
    return None if path is None else path.absolute()


def _announce(arguments: argparse.Namespace, ports: dict[str, str], size: GridSize | None) -> None:
    """Say where the devices are, and write a configuration that uses them."""
    file: Path | None = arguments.write_config
    if file is not None:
        write_config(file, ports, size)
    if arguments.json:
        print_json({"devices": ports, "config": None if file is None else str(file)})
        return
    print_pairs(ports.items())
    if file is not None:
        err().print(f"now, in another terminal: robotd --config {file}", markup=False)
    err().print("Ctrl-C ends it")


def robot_of(arguments: argparse.Namespace) -> EmulatedRobot:
    """Return the robot that the options of :func:`world_arguments` describe."""
    return load_robot(arguments.world, arguments.seed, odometry=OdometrySource(arguments.odometry))


def _sim_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("world", metavar="WORLD", help=f"{', '.join(world_names())}, or a file of one")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="same seed, same noise (default: 1)")
    odometry_argument(parser)
    parser.add_argument("--truth", type=Path, metavar="FILE", help="note in it where the robot really came to rest")
    _lines_arguments(parser)


def odometry_argument(parser: argparse.ArgumentParser) -> None:
    """Let the command line choose what the wheels say in a recorded building."""
    parser.add_argument(
        "--odometry",
        choices=[source.value for source in OdometrySource],
        default=OdometrySource.CORRECTED.value,
        help="in a recorded building: the log's corrected poses, or what its robot believed (default: corrected)",
    )


def _lines_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--links", type=Path, metavar="DIR", help="keep links drive, pantilt and rangefinder there")
    parser.add_argument("--write-config", type=Path, metavar="FILE", help="write a robotd.toml for these devices")


VERBS = (
    Verb(
        "sim",
        "simulate a robot in a room: its three boards, on pseudo-terminals",
        "robotctl sim laboratory --write-config lab/robotd.toml",
        _sim,
        _sim_arguments,
    ),
)
