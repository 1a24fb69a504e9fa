"""A simulated room: explore it, save the map, drive about and be found on it, and find itself when nothing is known."""

import argparse
import shutil
from contextlib import suppress
from dataclasses import dataclass
from itertools import count
from pathlib import Path

import numpy as np
from rich.console import Console

from robotd.cli.demo.mission import Trial, follow, print_readings, print_trials, stage
from robotd.cli.demo.rig import FINISHED, Rig, rig, wired
from robotd.cli.demo.true_pose import true_pose, true_way
from robotd.cli.exit_codes import FAILED, OK
from robotd.cli.outputs import DEMO_MARK, write
from robotd.cli.pictures.plots_extra import require_plots
from robotd.cli.show.terminal import bold, command_line
from robotd.client import Client
from robotd.config import Config
from robotd.contract.events import MapChanged
from robotd.contract.explored import ExploringEnded
from robotd.contract.missions import DriveTo, Explore, Localize, MapStart, Mission, PriorHeading
from robotd.contract.ways import Point
from robotd.core.errors import RobotdError
from robotd.core.pose import Pose2
from robotd.core.reading import Sweep
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.readings import Readings
from robotd.grid.tables import NO_INFORMATION
from robotd.localization.count.rank_grid import RankGrid
from robotd.localization.ready_map import ReadyMap
from robotd.mission.motion.steering import DrivingSettings
from robotd.sim.buildings.world import World, load_world


def run(arguments: argparse.Namespace) -> int:
    """Run the demonstration and return the exit code."""
    require_plots("demo room")
    console = stage()
    world = load_world(arguments.world)
    if not world.probes_m:
        raise RobotdError(f"{arguments.world}: has no probes_m, places to be found at: a demonstration needs one")
    directory = fresh(arguments.out)
    words = f": the {world.name}, seed {arguments.seed}; everything lives in {directory}"
    console.print(bold("robotd demo") + words)
    emulator = ["sim", arguments.world, "--seed", str(arguments.seed)]
    with rig(directory, wired(Config(driving=brisk()), directory), emulator) as parts:
        client = parts.client
        recording = client.record_start("recording.mcap")
        client.arm()
        made = _mapped(parts, console, world, arguments.stops)
        print_readings(console, made.sweeps)
        entry = client.map_save()
        console.print(f"  map saved: {directory / 'maps' / entry.name / str(entry.version)} ({entry.digest[:12]})")
        trials = [_localize_at(parts, console, probe_m) for probe_m in world.probes_m[: arguments.localizations]]
        the_map = client.map_show()
        if arguments.stops is None:
            trials.append(_carried_off(parts, console, world.name))
        client.record_stop()
    known = (
        "heading from odometry" if arguments.stops is not None else "heading from odometry, the last time unknown, too"
    )
    console.print(f"Found in it, {len(trials)} times (position unknown in the whole map, {known}):")
    print_trials(console, trials)
    _draw(directory, world, made, the_map, trials[-1])
    console.print(f"  every byte recorded: {recording}; try: {command_line('robotctl', 'replay', recording)}")
    console.print(f"  pictures: {', '.join(str(file) for file in sorted(directory.glob('*.png')))}")
    return OK if all(trial.error_m is not None for trial in trials) else FAILED


def fresh(directory: Path) -> Path:
    """Return an empty directory; what an earlier demonstration left there goes, but for the map of one that failed."""
    directory = directory.resolve()
    _keep_unfinished(directory)
    for name in ("devices", "run", "maps", "recordings"):
        shutil.rmtree(directory / name, ignore_errors=True)
    for file in (*directory.glob("*.png"), *directory.glob("*.mcap"), directory / "truth.jsonl"):
        file.unlink(missing_ok=True)
    write(directory / DEMO_MARK, b"")
    return directory


def _keep_unfinished(directory: Path) -> None:
    """Keep what one left that did not come to its end, however that was: failed, interrupted, killed."""
    mark = directory / DEMO_MARK
    if not any((directory / "maps").glob("*/*/")) or (mark.exists() and mark.read_bytes() == FINISHED):
        return
    kept = next(kept for number in count(1) if not (kept := directory / f"failed-{number}").exists())
    kept.mkdir()
    for name in ("maps", "recordings", "robotd.log"):
        with suppress(FileNotFoundError):
            (directory / name).rename(kept / name)


def brisk() -> DrivingSettings:
    """Return how to drive when somebody is watching."""
    return DrivingSettings(speed_mps=0.6, turn_radps=1.5, deceleration_mps2=0.4, turn_deceleration_radps2=2.0)


@dataclass(frozen=True, slots=True)
class _Made:
    """How the map was made."""

    sweeps: tuple[Sweep, ...]
    stops_m: tuple[Point, ...]
    """Where the robot really stopped, the start first."""
    way_m: tuple[Point, ...]
    """The way that it really went between them, corner by corner."""
    explored: ExploringEnded | None
    """What exploring left open; None if the robot was told where to stop."""


def _mapped(parts: Rig, console: Console, world: World, stops: int | None) -> _Made:
    """Make the map."""
    if stops is not None:
        console.print("Making the map, stop by stop:")
        mission: Mission = MapStart.of(world.name, world.stops_m[:stops], world.start_pose)
    else:
        console.print("Exploring: after each look round it goes where the most is expected to be seen.")
        mission = Explore.of(world.name, world.start_pose)
    sweeps, _, explored = follow(console, parts.client, mission)
    times_ns = [sweep.readings[0].time_ns for sweep in sweeps]
    stood = [true_pose(parts.truth_file, time_ns) for time_ns in times_ns]
    went = true_way(parts.truth_file, times_ns[-1])
    return _Made(sweeps, tuple(map(_place, stood)), tuple(map(_place, went)), explored)


def _place(pose: Pose2) -> Point:
    return pose.x_m, pose.y_m


def _carried_off(parts: Rig, console: Console, name: str) -> Trial:
    """Load the map again, as if the robot had been carried there: odometry says nothing of where it is on it."""
    console.print("Carried off: the map is loaded again, neither place nor heading is known, and it looks round:")
    parts.client.map_load(name)
    (sweep,), estimate, _ = follow(console, parts.client, Localize(heading=PriorHeading.UNKNOWN))
    assert estimate is not None  # a localization that is done has one
    return Trial(sweep, true_pose(parts.truth_file, sweep.readings[0].time_ns), estimate)


def _localize_at(parts: Rig, console: Console, probe_m: tuple[float, float]) -> Trial:
    console.print(f"Driving to ({probe_m[0]:.1f}, {probe_m[1]:.1f}) m and looking round:")
    follow(console, parts.client, DriveTo(*reachable(parts.client, console, probe_m)))
    (sweep,), estimate, _ = follow(console, parts.client, Localize())
    assert estimate is not None  # a localization that is done has one
    return Trial(sweep, true_pose(parts.truth_file, sweep.readings[0].time_ns), estimate)


def reachable(client: Client, console: Console, probe_m: tuple[float, float]) -> tuple[float, float]:
    """Return a place, or if the map the robot made has none there, the nearest that it can drive to.

    One wrong range, which nothing has looked through since, is an obstacle on the map: to be found somewhere near
    shows as much.
    """
    way = client.plan_to(*probe_m)
    if way.nearest_m is None:
        return probe_m
    console.print(f"  {way.message}: it goes there")
    return way.nearest_m


def _draw(directory: Path, world: World, made: _Made, the_map: MapChanged, last: Trial) -> None:
    from robotd.cli.pictures import rooms as pictures  # noqa: PLC0415  # heavy, and only needed now
    from robotd.cli.pictures.maps_in_the_making import draw_explored  # noqa: PLC0415  # as above

    walls = [np.array(wall.points_m) for wall in world.wall]
    radius_m, way_m = Config().planning.robot_radius_m, np.array(made.way_m)
    pictures.draw_room(
        *(directory / "room.png", f"The {world.name}", walls),
        stops_m=made.stops_m,
        path_m=way_m,
        robot_radius_m=radius_m,
    )
    draw_explored(
        *(directory / "map.png", "The robot's map", the_map.spec, the_map.values),
        stops_m=made.stops_m,
        way_m=way_m,
        left=() if made.explored is None else made.explored.left,
    )
    ranks = rank_of(the_map, last.sweep, last.estimate.best.heading_rad if last.estimate.best else 0.0)
    pictures.draw_localization(
        directory / "localization.png",
        "Where is the robot?",
        the_map.spec,
        ranks.rank[0],
        obstacles=the_map.values > NO_INFORMATION,
        truth=pictures.Mark(last.truth, radius_m),
        estimate=last.estimate.best,
    )


def rank_of(the_map: MapChanged, sweep: Sweep, heading_rad: float) -> RankGrid:
    """Return the rank grid of a sweep on a map: what the daemon saw when it decided."""
    settings = Config().localization
    grid = OccupancyGrid(the_map.spec, the_map.values)
    levels = ReadyMap.of(grid, settings).prepared
    ranks = RankGrid(levels.maps[0], (heading_rad,))
    ranks.add_by_level(Readings.of(sweep.measured), levels)
    return ranks
