"""How long a real daemon takes from SIGTERM until none of its processes is left, whatever its head computes."""

import asyncio
import random
from pathlib import Path

import numpy as np

from robotd.client import AsyncClient
from robotd.contract.missions import Localize, PriorHeading
from robotd.core.clock import now_ns
from robotd.core.grid_spec import GridSpec
from robotd.core.pose import IDENTITY
from robotd.grid.occupancy import OccupancyGrid
from robotd.maps.store import MapStore
from tests.support.real_rig import Rig, armed, child_of, ms_since, until

SIDE_CELLS = 2000
"""Of the map: to find a robot on it of whose heading nothing is known takes its head seconds."""
_NAME = "wide"
_LEASE_S = 10.0
_COMPUTED_S = 0.2
"""Of processor time, after which it is in the middle of that."""
_LATER_S = 1.0
_TICKS_PER_S = 100.0


def with_a_wide_map(rig: Rig, side_cells: int = SIDE_CELLS) -> None:
    """Lay a map into the store: rooms of 6 m, without end."""
    side_m = side_cells * 0.05
    cells = np.full((side_cells, side_cells), 20, np.uint8)
    cells[::120] = cells[:, ::120] = 230
    spec = GridSpec(0.05, -side_m / 2, -side_m / 2, cells.shape)
    MapStore(rig.directory / "maps").save(_NAME, OccupancyGrid(spec, cells), {}, 0)


async def ended_ms(rig: Rig, rng: random.Random) -> float:
    """Start a daemon, let its head compute, end it, and return how long that took."""
    async with rig.daemon(config="few.toml") as daemon:
        children = [child_of(daemon.pid, f"robotd.{name}") for name in ("front", "head")]
        async with AsyncClient(rig.runtime_dir, deadline_s=60.0) as client:
            await client.map_load(_NAME, robot_in_map=IDENTITY)
            await armed(client)
            before_s = _computed_s(children[1])
            await client.start(Localize(heading=PriorHeading.UNKNOWN), _LEASE_S)
            await until(lambda: _computed_s(children[1]) > before_s + _COMPUTED_S)
            await asyncio.sleep(rng.uniform(0.0, _LATER_S))
        began_ns = now_ns()
        daemon.terminate()
        await daemon.wait()
        await until(lambda: not any(Path(f"/proc/{child}").exists() for child in children))
        return ms_since(began_ns, now_ns())


def _computed_s(pid: int | None) -> float:
    """Return the processor time of all threads of a process."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / _TICKS_PER_S
