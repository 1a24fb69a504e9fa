"""What carries out each job: a table, a row each."""

import zlib
from collections.abc import Callable
from typing import Any

import numpy as np

from robotd.contract.ways import Way
from robotd.core.errors import MapError
from robotd.core.grid_bytes import unpacked_cells
from robotd.exploring.choice import ChoiceQuestion, choose
from robotd.grid.map_stops import MapStops
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.readings import Readings
from robotd.head.decided import chosen, stop_laid
from robotd.head.desk import Desk
from robotd.head.held import Held
from robotd.head.job import A, Done, Job
from robotd.head.jobs import (
    BeginMap,
    Choose,
    ChooseBearings,
    ChooseSafeWay,
    Chosen,
    FilesMade,
    Forget,
    Glance,
    Glanced,
    HeldMap,
    Insert,
    Inserted,
    MakeFiles,
    MapRef,
    Narrow,
    Narrowed,
    PlaceStop,
    Plan,
    Prepare,
    PreviewWay,
    Ranks,
    RanksShown,
    ReadMap,
    SafeWayChosen,
    ShowMap,
    ShowRanks,
    StopLaid,
    TakeMap,
    TakeReadings,
)
from robotd.head.parts_jobs import PartTaken, TakePart
from robotd.head.stop_placing import with_stop
from robotd.maps.grid_files import content_of, map_of
from robotd.maps.packed_content import PackedContent
from robotd.maps.stops_file import decode_packed_stops
from robotd.planning.path import Path, plan
from robotd.planning.traversable import free_cells
from robotd.recording.results import result_of
from robotd.sensing.common_ground import Room
from robotd.sensing.safe_ways import best_way
from robotd.sensing.telling_apart import Expected, telling_bearings
from robotd.slam.glance import glanced

_QUICK = 1
"""Level of zlib."""


def perform(desk: Desk, job: Job[A]) -> A:
    """Carry out a job and return its answer.

    Raises:
        RobotdError: it cannot be done; says why.
        NotHeld: it is about a map, or a stop, that is not held.
    """
    answer: A = _TABLE[type(job)](desk, job)
    return answer


def _begin_map(desk: Desk, job: BeginMap) -> HeldMap:
    grid = OccupancyGrid(job.spec, settings=job.settings)
    return desk.hold(MapRef(job.number), Held.of(grid, MapStops(job.settings))).told


def _take_map(desk: Desk, job: TakeMap) -> HeldMap:
    stops = None if job.stops is None else decode_packed_stops(job.stops)
    grid = OccupancyGrid(job.spec, unpacked_cells(job.packed, job.spec), job.settings)
    return desk.hold(MapRef(job.number), Held.of(grid, stops)).told


def _read_map(desk: Desk, job: ReadMap) -> HeldMap:
    grid, stops = map_of(job.content.unpacked(), desk.settings.grid)
    return desk.hold(MapRef(job.number), Held.of(grid, stops)).told


def _show_map(desk: Desk, job: ShowMap) -> HeldMap:
    return desk.map(job.map).told


def _make_files(desk: Desk, job: MakeFiles) -> FilesMade:
    held = desk.map(job.map)
    content, remark = content_of(held.grid, held.stops)
    return FilesMade(PackedContent.of(content), remark)


def _take_part(desk: Desk, job: TakePart) -> PartTaken:
    packed = desk.parts.take(job.sha256, job.size_bytes, job.offset_bytes, job.part)
    if packed is None:
        return PartTaken(job.offset_bytes + len(job.part), None)
    try:
        grid = OccupancyGrid(job.spec, unpacked_cells(packed, job.spec), desk.settings.grid)
    except ValueError as error:
        raise MapError(str(error)) from error
    content, _ = content_of(grid, None)
    return PartTaken(job.size_bytes, FilesMade(PackedContent.of(content), None))


def _insert(desk: Desk, job: Insert) -> Inserted:
    before = desk.map(job.map)
    held, cells = before.with_sweep(job.sweep, job.map_from_robot)
    desk.hold(MapRef(job.map.number, job.map.generation + 1), held)
    values = held.grid.cells.reshape(-1)[cells]
    stops = None if held.stops is None else len(held.stops.stops)
    return Inserted(cells.astype("<i8", copy=False).tobytes(), values.tobytes(), held.digest, stops)


def _place_stop(desk: Desk, job: PlaceStop) -> StopLaid:
    before = desk.map(job.map)
    localization = desk.settings.localization
    made = with_stop(before, job.sweep, job.travel, job.map_from_robot, localization, found_again=job.found_again)
    desk.hold(MapRef(job.map.number, job.map.generation + 1), made.held)
    return stop_laid(made, job.time_ns, job.map_id)


def _glance(desk: Desk, job: Glance) -> Glanced:
    survey = desk.map(job.map).survey
    if survey is None:  # odometry alone says where stops are
        return Glanced(job.since @ job.travel.step, is_found=False)
    return Glanced(*glanced(survey, Readings.of(job.readings), job.since, job.travel))


def _prepare(desk: Desk, job: Prepare) -> Done:
    desk.begin(job)
    return Done()


def _take_readings(desk: Desk, job: TakeReadings) -> Done:
    estimator = desk.stop(job.stop)
    estimator.add(*job.readings)
    estimator.add_slants(*job.slants)
    return Done()


def _narrow(desk: Desk, job: Narrow) -> Narrowed:
    estimator = desk.stop(job.stop)
    estimator.add(*job.readings)
    estimator.add_slants(*job.slants)
    estimate = estimator.estimate(job.time_ns, final=job.final)
    entry = result_of(estimate)
    return Narrowed(estimate, None, None) if entry is None else Narrowed(estimate, entry.digest, entry.encoded)


def _show_ranks(desk: Desk, job: ShowRanks) -> RanksShown:
    # Who looks on waits for nothing, so the stop may be over.
    estimator = desk.stop(job.stop) if desk.holds_stop(job.stop) else None
    heat = None if estimator is None else estimator.heat()
    if estimator is None or heat is None:
        return RanksShown(None)
    # Here and not in the heart, which would be kept by it; the front and clients take it as it is.
    levels = zlib.compress(heat.levels.tobytes(), _QUICK)
    return RanksShown(Ranks(heat.spec, heat.block, heat.readings, heat.headings, levels))


def _plan(desk: Desk, job: Plan | PreviewWay) -> Way:
    held = desk.map(job.map)
    way = plan(held.grid, job.start, job.goal_m, desk.settings.planning, held.obstacles(job.met_m))
    if isinstance(way, Path):
        return Way(way.waypoints_m, way.length_m)
    return Way((), 0.0, way.hindrance, way.reason, way.nearest_m)


def _choose(desk: Desk, job: Choose) -> Chosen:
    held = desk.map(job.map)
    stops = () if held.stops is None else held.stops.stops
    stops_m = tuple((stop.map_from_robot.x_m, stop.map_from_robot.y_m) for stop in stops)
    question = ChoiceQuestion(job.start, stops_m, job.tried, job.within, job.cut_off_m, job.pace)
    return chosen(choose(held.grid, held.obstacles(job.tried.met_m), question, desk.settings.planning))


def _choose_bearings(desk: Desk, job: ChooseBearings) -> tuple[int, ...]:
    walls = desk.ready(job.map).meanings[0].walls
    poses, beliefs = [pose for pose, _ in job.rivals], [belief for _, belief in job.rivals]
    bearings_rad = np.array(job.bearings_rad)
    expected = Expected.at(walls, poses, bearings_rad, job.cutoff_m)
    return telling_bearings(expected, beliefs, bearings_rad, job.taken_rad, job.count)


def _choose_safe_way(desk: Desk, job: ChooseSafeWay) -> SafeWayChosen:
    ready, held, planning = desk.ready(job.map), desk.map(job.map), desk.settings.planning
    # As the planner sees it: what was hit last is an obstacle whatever the cell's value.
    obstacles = ~free_cells(held.grid, planning.gap_cells) | held.obstacles()
    room = Room(held.grid.spec, obstacles, planning.robot_radius_m, planning.clearance_m)
    return SafeWayChosen(best_way(room, ready.meanings[0].walls, job.rivals, job.cutoff_m, job.speed_mps))


def _forget(desk: Desk, job: Forget) -> Done:
    desk.forget(job.number)
    return Done()


_TABLE: dict[type[Job[Any]], Callable[[Desk, Any], Any]] = {
    BeginMap: _begin_map,
    TakeMap: _take_map,
    ReadMap: _read_map,
    ShowMap: _show_map,
    MakeFiles: _make_files,
    TakePart: _take_part,
    Insert: _insert,
    PlaceStop: _place_stop,
    Glance: _glance,
    Prepare: _prepare,
    TakeReadings: _take_readings,
    Narrow: _narrow,
    ShowRanks: _show_ranks,
    ChooseBearings: _choose_bearings,
    ChooseSafeWay: _choose_safe_way,
    Plan: _plan,
    PreviewWay: _plan,
    Choose: _choose,
    Forget: _forget,
}
