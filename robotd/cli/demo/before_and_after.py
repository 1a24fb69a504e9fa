"""A recorded building mapped from its raw odometry, as the daemon maps: pictures of it before and after."""

import itertools
from pathlib import Path

import numpy as np
from rich.console import Console

from robotd.contract.ways import Point
from robotd.core.pose import Pose2
from robotd.evaluation.recorded import Reach
from robotd.evaluation.surveyed import SurveyedLog, surveyed
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.logs.scan import RecordedLog
from robotd.slam.graph import EdgeKind
from robotd.slam.survey import SurveySettings

_REACH = Reach(range_max_m=30.0, clear_m=8.0)
"""As ``robotctl eval --slam`` believes recorded ranges."""
_CELL_M = 0.1
_MARGIN_M = 1.0


def draw_before_and_after(console: Console, directory: Path, log: RecordedLog) -> None:
    """Map a log from its raw odometry, and draw what the wheels alone make of it, and what placing and loops do."""
    console.print("Mapping all of it once more, from its raw odometry alone (a minute):")
    found = surveyed(log.scans, _REACH, SurveySettings())
    by_wheels = [log.scans[scan].odometry for scan in found.stops]
    graph = found.survey.graph
    placed = [graph.pose(stop) for stop in range(len(graph.stops))]
    loops = [(edge.earlier, edge.later) for edge in graph.edges if edge.kind is EdgeKind.LOOP]
    way_m = sum(one.distance_m(other) for one, other in itertools.pairwise(by_wheels))
    moved_m = max(one.distance_m(other) for one, other in zip(by_wheels, placed, strict=True))
    console.print(
        f"  {len(placed)} stops over {way_m:.0f} m, {len(loops)} loops closed; stops moved by up to {moved_m:.1f} m"
    )
    _draw(directory / "odometry.png", "Before: where its wheels put it", found, by_wheels, [])
    _draw(directory / "survey.png", "After: each stop placed, loops closed", found, placed, loops)


def _draw(file: Path, title: str, found: SurveyedLog, poses: list[Pose2], loops: list[tuple[int, int]]) -> None:
    from robotd.cli.pictures.maps_in_the_making import draw_stops  # noqa: PLC0415  # heavy, and only needed now

    places_m: list[Point] = [(pose.x_m, pose.y_m) for pose in poses]
    grid = _map(found, poses)
    draw_stops(
        *(file, title, f"{len(poses)} stops; cells of {_CELL_M * 1000:g} mm", grid.spec, grid.cells),
        way_m=np.array(places_m),
        loops_m=[(places_m[earlier], places_m[later]) for earlier, later in loops],
    )


def _map(found: SurveyedLog, poses: list[Pose2]) -> OccupancyGrid:
    """Return the map that the laid stops make at some poses."""
    graph = found.survey.graph
    laid = [(graph.stops[stop].readings, poses[stop]) for stop in graph.laid.tolist()]
    heads_m = np.concatenate([readings.heads_at(pose) for readings, pose in laid])
    places_m = np.array([(pose.x_m, pose.y_m) for pose in poses])
    # All of the way; but a wrong range in a hundred must not make the picture twice as large.
    low = np.minimum(np.percentile(heads_m, 0.5, axis=0), places_m.min(axis=0)).tolist()
    high = np.maximum(np.percentile(heads_m, 99.5, axis=0), places_m.max(axis=0)).tolist()
    settings = GridSettings(resolution_m=_CELL_M, rows=1, cols=1)
    grid = OccupancyGrid(settings.spec_covering((tuple(low), tuple(high)), _MARGIN_M), settings=settings)
    for readings, pose in laid:
        grid.lay(readings, pose)
    return grid
