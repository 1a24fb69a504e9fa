"""Maps in use, made and looked at without a mission."""

import itertools
from typing import cast

import numpy as np
from numpy.typing import NDArray

from robotd.app.compose import Daemon, head_settings
from robotd.children.in_process import InProcess
from robotd.config import Config
from robotd.core.counted import Counted
from robotd.core.grid_bytes import packed_cells, unpacked_cells
from robotd.core.grid_spec import GridSpec
from robotd.front.heart_side import LANES
from robotd.front.program import serve_clients
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.head.compute import Compute
from robotd.head.desk import Desk
from robotd.head.far import FarHead
from robotd.head.head import Head
from robotd.head.jobs import HeldMap, ShowMap, TakeMap
from robotd.head.near import HeadAtHand
from robotd.head.program import serve
from robotd.head.settings import HeadSettings
from robotd.mission.whereabouts.map_in_use import MapInUse

_NUMBERS = itertools.count(1000)


def head_on(compute: object, config: Config | None = None) -> HeadAtHand:
    """Return a head of this process that computes where it is asked, or where ``compute`` says."""
    return HeadAtHand(Desk(head_settings(config or Config())), unpaced(compute))


class NearHead(FarHead):
    """As the program has it, but as a task of this process: for whatever clock the loop has."""

    @classmethod
    def spawned(cls, settings: HeadSettings, log_level: str) -> "NearHead":
        return cls(settings, lambda: InProcess(serve))


def near_front(_runtime_dir: str, _counted: Counted) -> InProcess:
    """Return a front as the program has it, but as a task of this process."""
    return InProcess(serve_clients, LANES)


def unpaced(compute: object) -> Compute:
    """Return what runs functions as what it is: for any type, it hands back what they return."""
    return cast("Compute", compute)


def held(spec: GridSpec | None = None, digest: str = "digest", stops: int | None = None) -> HeldMap:
    """Return what is told of a blank map that nobody holds."""
    spec = spec or GridSettings(rows=20, cols=20).spec_covering(((0.0, 0.0),), 0.2)
    return HeldMap(spec, digest, memoryview(packed_cells(OccupancyGrid(spec).cells)), stops, GridSettings())


def place(name: str = "m", begun: HeldMap | None = None) -> MapInUse:
    """Return a map in use that nobody holds."""
    return MapInUse(name, name, next(_NUMBERS), begun or held())


async def place_of(head: Head, grid: OccupancyGrid, name: str) -> MapInUse:
    """Return a map in use, held by a head."""
    number = head.number()
    begun = await head.ask(TakeMap(number, grid.spec, memoryview(packed_cells(grid.cells)), grid.settings))
    return MapInUse(name, name, number, begun)


def head_of(daemon: Daemon) -> Head:
    return daemon.control._maps._head


async def cells_in_use(daemon: Daemon) -> NDArray[np.uint8]:
    """Return the cells of the map in use."""
    in_use = daemon.supervisor.whereabouts.map_in_use
    assert in_use is not None
    shown = await head_of(daemon).ask(ShowMap(in_use.ref))
    return unpacked_cells(shown.packed, shown.spec)
