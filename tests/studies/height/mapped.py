"""A world mapped at several tilts, by the head's own jobs: where a robot is in it, and which ways it would drive."""

import math
import random
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from robotd.app.compose import head_settings
from robotd.config import Config
from robotd.contract.estimate import PoseEstimate
from robotd.core.pose import Pose2
from robotd.core.reading import Tilt
from robotd.grid.map_stops import MapStops
from robotd.grid.occupancy import OccupancyGrid
from robotd.head.desk import Desk
from robotd.head.held import Held
from robotd.head.job_table import perform
from robotd.head.jobs import Forget, MapRef, Narrow, Plan, Prepare
from robotd.sim.buildings.world import World
from robotd.sim.physics.body import BodySettings
from robotd.sim.physics.walls import Plate, Point, clearance_m
from tests.studies.height.sight import sweep_at
from tests.studies.senses.trials import Came, came

_MARGIN_M = 3.0
_STOP_M, _STOP_RAD = 0.01, math.radians(0.2)
"""How far off the stops of the map are."""
_ROOM_M = BodySettings().radius_m + 0.05
"""What a robot needs round it that is put somewhere."""
_STEP_M = 0.02
_CONFIG = Config()
_STOP = 1


def places_in(world: World, count: int) -> Iterator[Pose2]:
    """Yield poses where the robot fits; by the world alone, so that all maps of it are asked about the same."""
    draw = random.Random(f"{world.name}/places")
    room, *things = (Plate(wall.points_m, 0.0) for wall in world.wall)
    xs_m, ys_m = zip(*room.corners_m, strict=True)
    for _ in range(count):
        at_m = (math.inf, math.inf)
        while (
            not room.holds(at_m)
            or any(thing.holds(at_m) for thing in things)
            or clearance_m(world.walls, at_m) < _ROOM_M
        ):
            at_m = draw.uniform(min(xs_m), max(xs_m)), draw.uniform(min(ys_m), max(ys_m))
        yield Pose2(*at_m, draw.uniform(-math.pi, math.pi))


@dataclass(frozen=True, slots=True)
class Ways:
    """What came of driving from some places to others."""

    free: int
    into_something: int
    refused: int


@dataclass(frozen=True, slots=True, eq=False)
class Mapped:
    """A map of a world, and the world."""

    world: World
    desk: Desk
    map: MapRef
    cut_off_m: float
    tilts: tuple[Tilt, ...]

    @classmethod
    def of(cls, world: World, cut_off_m: float, tilts: Sequence[Tilt]) -> "Mapped":
        """Map a world from its stops, as well as a robot does that is placed at each."""
        draw = random.Random(f"{world.name}/map")
        stops = [world.start_pose, *(Pose2(*stop_m, 0.0) for stop_m in world.stops_m)]
        spec = _CONFIG.grid.spec_covering([(stop.x_m, stop.y_m) for stop in stops], _MARGIN_M)
        held = Held.of(OccupancyGrid(spec, settings=_CONFIG.grid), MapStops(_CONFIG.grid))
        for number, stop in enumerate(stops):
            off = Pose2(draw.gauss(0, _STOP_M), draw.gauss(0, _STOP_M), draw.gauss(0, _STOP_RAD))
            held, _ = held.with_sweep(sweep_at(world, stop @ off, cut_off_m, tilts, f"stop {number}"), stop)
        desk, ref = Desk(head_settings(_CONFIG)), MapRef(0)
        desk.hold(ref, held)
        return cls(world, desk, ref, cut_off_m, tuple(tilts))

    def located(self, truth: Pose2, seed: str) -> PoseEstimate:
        """Return what a robot finds that knows nothing, by all layers that the map has."""
        sweep = sweep_at(self.world, truth, self.cut_off_m, self.tilts, seed)
        headings_rad = _CONFIG.localization.headings_all_round()
        perform(self.desk, Prepare(_STOP, self.map, "m", headings_rad, None, layers=bool(self.tilts)))
        narrowed = perform(self.desk, Narrow(_STOP, sweep.measured, 0, final=True, slants=sweep.slants))
        perform(self.desk, Forget(_STOP))
        return narrowed.estimate

    def looks(self, places: int) -> Counter[Came]:
        """Return what became of robots in some places."""
        return Counter(
            came(self.located(truth, f"look {number}"), truth)
            for number, truth in enumerate(places_in(self.world, places))
        )

    def ways(self, count: int) -> Ways:
        """Return what becomes of robots that know where they are, and drive from some places to others."""
        places = list(places_in(self.world, 2 * count))
        became = Counter(self._driven(start, goal) for start, goal in zip(places[::2], places[1::2], strict=True))
        return Ways(became["free"], became["into something"], became["refused"])

    def _driven(self, start: Pose2, goal: Pose2) -> str:
        way = perform(self.desk, Plan(self.map, start, (goal.x_m, goal.y_m)))
        if way.reason is not None:
            return "refused"
        corners = ((start.x_m, start.y_m), *way.waypoints_m)
        return "free" if all(map(self._is_free, corners, corners[1:])) else "into something"

    def _is_free(self, begin_m: Point, end_m: Point) -> bool:
        """Whether the body meets nothing on a leg, whatever its height."""
        steps = max(1, math.ceil(math.dist(begin_m, end_m) / _STEP_M))
        along = np.linspace(begin_m, end_m, steps + 1)
        radius_m = BodySettings().radius_m
        return all(clearance_m(self.world.walls, (float(x_m), float(y_m))) >= radius_m for x_m, y_m in along)
