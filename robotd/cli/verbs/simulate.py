"""``sim`` and ``fake``: simulated boards on pseudo-terminals."""

import argparse
import asyncio
import contextlib
from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from pathlib import Path

from robotd.cli.emulated import config_text, recorded_config_text, recorded_dialects, write_config
from robotd.cli.exit_codes import FAILED, OK
from robotd.cli.outputs import LINKS, MADE_CONFIG, TRUTH_LINES, output_argument
from robotd.cli.quantities import whole
from robotd.cli.show.terminal import command_line, err, out, print_json, print_pairs
from robotd.cli.verb import Verb
from robotd.cli.wheels import odometry_argument
from robotd.core.log import configure
from robotd.recording.reader import read
from robotd.sim.buildings.world import load_world, world_names
from robotd.sim.emulators.catalogue import DRIVES, OWN, PANTILTS, RANGEFINDERS, Dialects, Firmware
from robotd.sim.fakes.fake_robot import FakeRobot
from robotd.sim.faults.fault_words import FAULTS, meaning_of
from robotd.sim.faults.laid import run_faulty_on_ptys
from robotd.sim.faults.plan import PlannedFault, parse_plan
from robotd.sim.hosting.pace import PATIENCE_S
from robotd.sim.load import load_robot
from robotd.sim.recorded_robot import OdometrySource
from robotd.sim.robot import EmulatedRobot
from robotd.sim.runtime import run_on_ptys

_WORLD = "laboratory"


def _sim(arguments: argparse.Namespace) -> int:
    if arguments.explore:
        return _explored(arguments)
    boards = Firmware(arguments.boards)
    dialects = Dialects(arguments.drive, arguments.pantilt, arguments.rangefinder, boards)
    odometry = OdometrySource(arguments.odometry)
    robot = load_robot(arguments.world or _WORLD, arguments.seed, odometry=odometry, dialects=dialects)

    plan = parse_plan(arguments.faults) if arguments.faults else ()
    silence_s = {} if plan else {"silence_s": PATIENCE_S}  # who tries faults wants to see what they do to a real robot

    def write(file: Path, ports: dict[str, str]) -> None:
        settings = dialects.settings()
        write_config(file, config_text(ports, {device: {**settings.get(device, {}), **silence_s} for device in ports}))

    _serve(arguments, robot, write, truth_path=arguments.truth, plan=plan)
    return OK


def _explored(arguments: argparse.Namespace) -> int:
    """Let whole daemons explore in virtual time; a failure is one that did not end by itself."""
    from robotd.cli.expeditions.expedition import expedition  # noqa: PLC0415  # a whole daemon, needed here alone
    from robotd.cli.expeditions.expedition_table import print_expeditions  # noqa: PLC0415  # as above

    worlds = world_names() if arguments.world is None else (arguments.world,)
    done = []
    for world in map(load_world, worlds):
        for seed in range(arguments.seed, arguments.seed + arguments.seeds):
            done.append(expedition(world, seed))
            if not arguments.json:
                err().print(done[-1].words)
    if arguments.json:
        print_json([asdict(one) for one in done])
    else:
        print_expeditions(done)
    return OK if all(one.ended_by_itself for one in done) else FAILED


def _fake(arguments: argparse.Namespace) -> int:
    """Answer as recorded; what the daemon asks otherwise is logged as it happens, and counted at the end."""
    configure("warning")
    recording = read(arguments.file)
    robot = FakeRobot(recording, recorded_dialects(recording))

    def write(file: Path, ports: dict[str, str]) -> None:
        write_config(file, recorded_config_text(ports, recording))

    _serve(arguments, robot, write)
    if arguments.json:
        print_json({"finished": robot.finished, "mismatches": [asdict(found) for found in robot.mismatches]})
    else:
        end = "came to the end of the recording" if robot.finished else "did not come to the end of the recording"
        out().print(f"the daemon {end}; {len(robot.mismatches)} requests were not the recorded ones")
    return FAILED if robot.mismatches else OK


def _serve(
    arguments: argparse.Namespace,
    robot: EmulatedRobot,
    write: Callable[[Path, dict[str, str]], None],
    truth_path: Path | None = None,
    plan: tuple[PlannedFault, ...] = (),
) -> None:
    """Serve the boards on pseudo-terminals until Ctrl-C, which is how it ends."""
    # They go into a configuration, and the daemon may be started in another directory.
    links = None if arguments.links is None else arguments.links.absolute()

    def announce(ports: dict[str, str]) -> None:
        if arguments.write_config is not None:
            write(arguments.write_config, ports)
        _announce(ports, arguments.write_config, as_json=arguments.json)

    run = partial(run_on_ptys, say=err().print)
    if plan:
        run = partial(run_faulty_on_ptys, plan=plan, seed=arguments.seed, say=err().print)
    with contextlib.suppress(KeyboardInterrupt):
        asyncio.run(run(robot, announce=announce, directory=links, truth_path=truth_path))


def _announce(ports: dict[str, str], file: Path | None, *, as_json: bool) -> None:
    """Say where the devices are, and how to run a daemon on them."""
    if as_json:
        print_json({"devices": ports, "config": None if file is None else str(file)})
        return
    print_pairs(ports.items())
    if file is not None:
        err().print(f"now, in another terminal: {command_line('robotd', '--config', file)}")
    err().print("Ctrl-C ends it")


def _sim_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "world",
        nargs="?",
        metavar="WORLD",
        help=f"{', '.join(world_names())}, a file of one, or a map's yaml (default: {_WORLD})",
    )
    parser.add_argument(
        "--explore",
        action="store_true",
        help="no boards: let whole daemons explore it in virtual time, and say how well (default: all built-in worlds)",
    )
    parser.add_argument("--seeds", type=whole(1), default=3, metavar="N", help="robots that explore each (default: 3)")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="same seed, same noise (default: 1)")
    odometry_argument(parser)
    for device, table in (("drive", DRIVES), ("pantilt", PANTILTS), ("rangefinder", RANGEFINDERS)):
        parser.add_argument(
            f"--{device}", choices=list(table), default=OWN, help=f"what the {device} speaks (default: {OWN})"
        )
    parser.add_argument(
        "--boards",
        choices=[firmware.value for firmware in Firmware],
        default=Firmware.PYTHON.value,
        help="what our own boards run: Python that does the same, or the firmware in C (default: python)",
    )
    output_argument(parser, "--truth", TRUTH_LINES, "note in it where the robot really came to rest")
    _lines_arguments(parser)
    words = "\n".join(f"  {word:10}{meaning_of(word)}" for word in FAULTS)
    faults = parser.add_argument_group(
        "faults",
        "DEVICE:FAULT@START[+DURATION],... lets a fault begin on the cable of\n"
        "drive, pantilt, rangefinder or all of them, START seconds after the\n"
        f"simulation did; without a DURATION it lasts to the end. The faults:\n\n{words}",
    )
    faults.add_argument(
        "--faults", metavar="PLAN", help="what goes wrong: drive:unplug@20s+3s,rangefinder:garbage@35s+2s"
    )


def _fake_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", type=Path, metavar="RECORDING", help="a recording (.mcap)")
    _lines_arguments(parser)


def _lines_arguments(parser: argparse.ArgumentParser) -> None:
    output_argument(parser, "--links", LINKS, "keep links drive, pantilt and rangefinder there")
    output_argument(parser, "--write-config", MADE_CONFIG, "write a robotd.toml for these devices")


VERBS = (
    Verb(
        "sim",
        "simulate a robot in a room: its three boards, on pseudo-terminals",
        "robotctl sim laboratory --write-config lab/robotd.toml",
        _sim,
        _sim_arguments,
    ),
    Verb(
        "fake",
        "answer as the recorded boards did, on pseudo-terminals: run a fresh daemon on them",
        "robotctl fake a.mcap --write-config again/robotd.toml",
        _fake,
        _fake_arguments,
    ),
)
