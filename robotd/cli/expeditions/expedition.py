"""A whole daemon on a simulated robot whose wheels lie, set down in a world: it explores, in virtual time."""

import asyncio
import contextlib
import tempfile
from collections.abc import AsyncIterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from robotd.app.compose import Daemon, compose, head_settings
from robotd.app.daemon import new_journal
from robotd.cli.expeditions.offline_tour import offline_tour
from robotd.config import Config
from robotd.contract.events import Event, MissionProgress, SweepDone
from robotd.contract.explored import ExploringEnded
from robotd.contract.missions import Explore
from robotd.contract.requests import Arm
from robotd.core.broadcast import Subscription
from robotd.core.clock import NS_PER_S, now_ns, run_virtual
from robotd.core.pose import Pose2
from robotd.grid.footprints import dilate
from robotd.grid.tables import NO_INFORMATION
from robotd.head.compute import ThreadCompute
from robotd.head.desk import Desk
from robotd.head.held import Held
from robotd.head.near import HeadAtHand
from robotd.sim.buildings.world import World
from robotd.sim.physics.noise import NoiseSettings, stream
from robotd.sim.robot import SimSettings, SimulatedRobot
from robotd.sim.runtime import connectors

_LEASE_S = 1e6
_SCALE_ERROR = 0.05
_DRIFT_RAD = 0.04
"""After a metre; 3 degrees from one stop to the next."""
_SQUARE = np.ones((3, 3), np.bool_)


@dataclass(frozen=True, slots=True)
class Expedition:
    """What came of one robot in one world."""

    world: str
    seed: int
    ending: str
    """Why it ended; of one that did not end by itself, what ended it."""
    ended_by_itself: bool
    seen_share: float
    """Of what can be seen from anywhere that the robot can go."""
    worst_m: float
    """By how much a stop of the map is off at most, in the end."""
    stops: int
    way_m: float
    took_s: float
    """In the robot's own time."""
    tour_stops: int
    """Of somebody who knows the map, see :func:`offline_tour`."""
    tour_way_m: float

    @property
    def words(self) -> str:
        """Say it in a line."""
        seen = f"{self.ending}, {self.seen_share:.1%} seen, worst pose {1000 * self.worst_m:.0f} mm"
        tour = f"{self.stops} stops ({self.tour_stops}), {self.way_m:.1f} m ({self.tour_way_m:.1f})"
        return f"{self.world} {self.seed}: {seen}, {tour}, {self.took_s:.0f} s"


def expedition(world: World, seed: int) -> Expedition:
    """Return what came of a robot of that seed: the same seed, the same answer."""
    return run_virtual(_explored(world, seed))


async def _explored(world: World, seed: int) -> Expedition:
    config, robot = Config(), _robot(world, seed)
    desk = Desk(head_settings(config))
    truths: dict[int, Pose2] = {}
    async with _living(config, robot, desk) as (daemon, events):
        began_ns = now_ns()
        mission_id = daemon.control.start(Explore.of(world.name, world.start_pose), _LEASE_S)
        ended, last = await _followed(events, mission_id, robot, truths)
        took_s = (now_ns() - began_ns) / NS_PER_S
        place = daemon.supervisor.whereabouts.map_in_use
        assert place is not None  # the mission began one
        held = desk.map(place.ref)
    tour = offline_tour(world, held.grid.spec, config.planning, config.rangefinder.range_max_m)
    return Expedition(
        world=world.name,
        seed=seed,
        ending=last.message if ended is None else ended.ending,
        ended_by_itself=ended is not None,
        seen_share=_seen_share(held, tour.visible),
        worst_m=_worst_m(held, truths),
        stops=len(truths),
        way_m=0.0 if ended is None else ended.way_m,
        took_s=took_s,
        tour_stops=tour.stops,
        tour_way_m=tour.way_m,
    )


def _robot(world: World, seed: int) -> SimulatedRobot:
    scale = stream(seed, "lying wheels").uniform(-_SCALE_ERROR, _SCALE_ERROR)
    noise = replace(NoiseSettings(), translation_scale_error=scale, drift_noise_rad=_DRIFT_RAD)
    return SimulatedRobot(world, seed, SimSettings(noise=noise))


@contextlib.asynccontextmanager
async def _living(
    config: Config, robot: SimulatedRobot, desk: Desk
) -> AsyncIterator[tuple[Daemon, Subscription[Event]]]:
    """Bring a daemon to life, armed, whose lines and head are in memory and whose maps are gone afterwards."""
    compute = ThreadCompute()  # the virtual loop does at once what it is to do
    with tempfile.TemporaryDirectory(prefix="robotd-expedition-") as directory:
        here = replace(config, maps=replace(config.maps, dir=directory))
        async with connectors(robot) as connects:
            daemon = compose(here, connects, HeadAtHand(desk, compute), compute, new_journal(here))
            with daemon.control.events.subscribe(depth=_EVENTS) as events:
                tasks = [asyncio.create_task(part, name=name) for name, part in daemon.parts().items()]
                try:
                    await _all_there(daemon)
                    await daemon.control.perform(Arm())
                    yield daemon, events
                finally:
                    for task in tasks:
                        task.cancel()
                    await asyncio.gather(*tasks, return_exceptions=True)
    compute.close()


async def _all_there(daemon: Daemon) -> None:
    while absent := daemon.robot.absent:
        device = next(device for device in daemon.robot.devices if device.name == absent[0])
        with device.status_changes.subscribe() as changes:
            await changes.get()


async def _followed(
    events: Subscription[Event], mission_id: int, robot: SimulatedRobot, truths: dict[int, Pose2]
) -> tuple[ExploringEnded | None, MissionProgress]:
    """Follow a mission to its end, and note where each sweep was really taken."""
    ended = None
    async for event in events:
        match event:
            case SweepDone():
                truths[event.sweep.number] = robot.truth
            case ExploringEnded():
                ended = event
            case MissionProgress() if event.mission_id == mission_id and event.is_last:
                return ended, event
    raise AssertionError("a subscription never ends")


def _seen_share(held: Held, visible: NDArray[np.bool_]) -> float:
    """Return how much of what is visible the map knows; what is a cell off, as its poses are, counts."""
    known = dilate(held.grid.cells != NO_INFORMATION, _SQUARE)
    return float((known & visible).sum() / visible.sum())


def _worst_m(held: Held, truths: dict[int, Pose2]) -> float:
    assert held.stops is not None  # a map that is explored keeps them
    return max(stop.map_from_robot.distance_m(truths[stop.number]) for stop in held.stops.stops)


_EVENTS = 1_000_000
"""More than a mission tells: nobody who listens here is slow."""
