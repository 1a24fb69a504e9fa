"""A short session, recorded: a stop of the office is mapped, and the robot finds itself there."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from robotd.config import Config
from robotd.contract.events import MapChanged
from robotd.contract.missions import Localize, MapStart
from robotd.contract.requests import RecordStart, RecordStop
from robotd.core.clock import run_virtual
from robotd.core.grid_bytes import unpacked_cells
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.sim.buildings.world import load_world
from robotd.sim.robot import SimulatedRobot
from tests.support.living import living


def record_session(directory: Path) -> Path:
    """Return the recording that is made of it below a directory."""
    path = directory / "recordings" / "a.mcap"
    run_virtual(_record(directory, path))
    return path


async def _record(directory: Path, path: Path) -> None:
    """Take enough readings to be sure."""
    robot = SimulatedRobot(load_world("office"), seed=5)
    async with living(directory, robot, replace(Config(), sweep=SweepSettings(readings=150))) as it:
        await it.daemon.control.perform(RecordStart(str(path)))
        await it.done(MapStart.of("office", (), robot.start))
        await it.done(Localize())
        await it.daemon.control.perform(RecordStop())


def laid_together(changes: list[MapChanged]) -> NDArray[np.uint8]:
    """Return the map that all changes come to, cell by cell."""
    cells = np.empty((0, 0), np.uint8)
    for change in changes:
        if change.whole:
            assert change.packed is not None
            cells = unpacked_cells(change.packed, change.spec).copy()
        else:
            for at, value in zip(change.cells.tolist(), change.values.tolist(), strict=True):
                cells[divmod(at, change.spec.cols)] = value
    return cells
