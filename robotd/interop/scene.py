"""What a program that shows the robot must remember of what it was told: where frames lie, and the map."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from robotd.contract.estimate import PoseEstimate
from robotd.contract.events import MapChanged
from robotd.core.grid_bytes import unpacked_cells
from robotd.core.pose import IDENTITY, Odometry, Pose2


def _no_cells() -> NDArray[np.uint8]:
    return np.empty((0, 0), np.uint8)


@dataclass(slots=True)
class Scene:
    """Takes the events one after the other; frames are tied by the latest that was told."""

    in_odom: Pose2 = IDENTITY
    map_from_odom: Pose2 = IDENTITY
    cells: NDArray[np.uint8] = field(default_factory=_no_cells)
    """``uint8[rows, cols]``, of the map in use, as changed so far."""

    def take(self, event: object) -> None:
        """Take the next event; most change nothing."""
        match event:
            case Odometry():
                self.in_odom = event.in_odom
            case PoseEstimate() if event.map_from_odom is not None:
                self.map_from_odom = event.map_from_odom
            case MapChanged():
                self._change(event)

    def _change(self, change: MapChanged) -> None:
        if change.whole:
            # Where it was packed already it has no values of its own.
            whole = change.values if change.packed is None else unpacked_cells(change.packed, change.spec)
            self.cells = whole.copy()
        elif self.cells.shape == change.spec.shape:
            self.cells.flat[change.cells] = change.values
