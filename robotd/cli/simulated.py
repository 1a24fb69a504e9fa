"""Simulated boards on pseudo-terminals, served until Ctrl-C: what ``sim`` and ``fake`` do."""

import argparse
import asyncio
import contextlib
from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from pathlib import Path

from robotd.cli.emulated import config_text, recorded_config_text, recorded_dialects, write_config
from robotd.cli.exit_codes import FAILED, OK
from robotd.cli.show.terminal import command_line, err, out, print_json, print_pairs
from robotd.core.log import configure
from robotd.recording.reader import read
from robotd.sim.buildings.world import load_world, world_names
from robotd.sim.emulators.catalogue import Dialects, Firmware
from robotd.sim.fakes.fake_robot import FakeRobot
from robotd.sim.faults.laid import run_faulty_on_ptys
from robotd.sim.faults.plan import PlannedFault, parse_plan
from robotd.sim.hosting.pace import PATIENCE_S
from robotd.sim.load import load_robot
from robotd.sim.physics.laser import LaserSettings
from robotd.sim.recorded_robot import OdometrySource
from robotd.sim.robot import EmulatedRobot, SimulatedRobot
from robotd.sim.runtime import run_on_ptys


def simulate(arguments: argparse.Namespace, usual_world: str) -> int:
    """Serve a simulated robot until Ctrl-C, or let whole daemons explore; return the exit code."""
    if arguments.explore:
        return _explored(arguments)
    boards = Firmware(arguments.boards)
    dialects = Dialects(arguments.drive, arguments.pantilt, arguments.rangefinder, boards)
    odometry = OdometrySource(arguments.odometry)
    robot = load_robot(arguments.world or usual_world, arguments.seed, odometry=odometry, dialects=dialects)

    plan = parse_plan(arguments.faults) if arguments.faults else ()
    silence_s = {} if plan else {"silence_s": PATIENCE_S}  # who tries faults wants to see what they do to a real robot

    def write(file: Path, ports: dict[str, str]) -> None:
        settings = dialects.settings()
        # As somebody measured it: a recorded building has one height, which its log does not say.
        head = {"height_m": LaserSettings().height_m} if isinstance(robot, SimulatedRobot) else {}
        further = {"pantilt": {**silence_s, **head}}
        of_devices = {device: settings.get(device, {}) | further.get(device, silence_s) for device in ports}
        write_config(file, config_text(ports, of_devices))

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


def fake(arguments: argparse.Namespace) -> int:
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
