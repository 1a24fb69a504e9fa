"""A recorded building: visit real stops of a real log, map it, and be found at stops that were kept out of the map."""

import argparse
from dataclasses import replace
from pathlib import Path

from rich.console import Console

from robotd.cli.demo.before_and_after import draw_before_and_after
from robotd.cli.demo.mission import Trial, follow, print_readings, stage
from robotd.cli.demo.rig import Rig, rig, wired
from robotd.cli.demo.room import fresh
from robotd.cli.demo.true_pose import true_pose
from robotd.cli.exit_codes import OK
from robotd.cli.logs import Reading, refuse_raw_odometry
from robotd.cli.outputs import write
from robotd.cli.pictures.plots_extra import require_plots
from robotd.cli.show.terminal import bold
from robotd.config import Config
from robotd.contract.estimate import PoseState
from robotd.contract.events import MapChanged
from robotd.contract.missions import DriveTo, Legs, Localize, MapStart
from robotd.core.errors import MissionError
from robotd.localization.stop_poses import StopPoses
from robotd.mission.motion.steering import DrivingSettings
from robotd.sim.buildings.building import RecordedBuilding, encode_recorded_building, select_stops
from robotd.sim.load import load_robot
from robotd.sim.recorded_robot import OdometrySource

_RIGHT_M = 0.3


def run(arguments: argparse.Namespace) -> int:
    """Run the demonstration and return the exit code."""
    console = stage()
    require_plots("demo building")
    log = Reading.of(arguments).read(arguments.log)
    if not arguments.raw:
        refuse_raw_odometry(arguments.log, log)
    directory = fresh(arguments.out)
    file = directory / "building.json.gz"
    every = max(2, round(1 + arguments.stops / max(1, arguments.trials)))
    wanted = arguments.stops + arguments.trials
    stops = select_stops(log, arguments.spacing_m, keep_out_every=every, limit=wanted)
    write(file, encode_recorded_building(RecordedBuilding(arguments.log.name, stops)))
    robot = load_robot(str(file), odometry=OdometrySource(arguments.odometry))
    console.print(bold("robotd demo") + f": the building of {arguments.log.name}; everything lives in {directory}")
    console.print(f"  {1 + len(robot.stops_m)} stops for the map, {len(robot.probes_m)} kept out of it")
    emulator = ["sim", str(file), "--odometry", arguments.odometry]
    with rig(directory, wired(_config(), directory), emulator) as parts:
        parts.client.arm()
        console.print("Making the map, along straight legs as the recorded robot went:")
        mapping = MapStart.of("building", robot.stops_m, robot.start, Legs.STRAIGHT)
        print_readings(console, follow(console, parts.client, mapping).sweeps)
        entry = parts.client.map_save()
        console.print(f"  map saved: {directory / 'maps' / entry.name / str(entry.version)} ({entry.digest[:12]})")
        the_map = parts.client.map_show()
        # Backwards, from where the map ended: so the legs keep to the way that the recorded robot went.
        probes_m = tuple(reversed(robot.probes_m))
        trials = [_localize_at(parts, console, number, probe_m) for number, probe_m in enumerate(probes_m, 1)]
    _report(console, trials)
    _draw(directory, the_map, ((robot.start.x_m, robot.start.y_m), *robot.stops_m))
    draw_before_and_after(console, directory, log)
    return OK


def _config() -> Config:
    config = Config()
    driving = DrivingSettings(
        speed_mps=1.5,
        turn_radps=3.0,
        deceleration_mps2=1.0,
        turn_deceleration_radps2=4.0,
        gain_hz=2.0,
    )
    # Twenty metres and more lie between the walls of a hall; the laser of the recorded robot saw them.
    return replace(
        config,
        driving=driving,
        rangefinder=replace(config.rangefinder, range_max_m=12.0),
        # A recorded robot sees only where it was, and that is known in its odometry's frame.
        localization=replace(config.localization, stops=StopPoses.ODOMETRY),
    )


def _localize_at(parts: Rig, console: Console, number: int, probe_m: tuple[float, float]) -> Trial:
    follow(console, parts.client, DriveTo(*probe_m, legs=Legs.STRAIGHT))
    (sweep,), estimate, _ = follow(console, parts.client, Localize(tie=False))
    if estimate is None:
        raise MissionError("a localization ended without an estimate")
    trial = Trial(sweep, true_pose(parts.truth_file, sweep.readings[0].time_ns), estimate)
    error = "no unique pose" if trial.error_m is None else f"{1000 * trial.error_m:.0f} mm off"
    console.print(
        f"  {number:3} at ({trial.truth.x_m:7.2f}, {trial.truth.y_m:7.2f}) m: {estimate.state}, {error},"
        f" {estimate.best_rank or 'too few'} of {estimate.readings} readings, {len(estimate.regions)} regions"
    )
    return trial


def _report(console: Console, trials: list[Trial]) -> None:
    right = sum(trial.error_m is not None and trial.error_m <= _RIGHT_M for trial in trials)
    wrong = sum(trial.error_m is not None and trial.error_m > _RIGHT_M for trial in trials)
    ambiguous = sum(trial.estimate.state is PoseState.AMBIGUOUS for trial in trials)
    lost = sum(trial.estimate.state is PoseState.LOST for trial in trials)
    console.print(
        bold(f"{right} of {len(trials)} kept-out stops localized within {_RIGHT_M:g} m")
        + f" ({100 * right / max(1, len(trials)):.0f} %; heading from the log, position unknown in the whole map);"
        f" wrong and sure {wrong}, ambiguous {ambiguous}, lost {lost}"
    )


def _draw(directory: Path, the_map: MapChanged, stops_m: tuple[tuple[float, float], ...]) -> None:
    from robotd.cli.pictures import rooms as pictures  # noqa: PLC0415  # heavy, and only needed now

    pictures.draw_map(directory / "building.png", "A recorded building", the_map.spec, the_map.values, stops_m=stops_m)
