"""One of the things that a map may mean: that its walls stand where they are drawn, or only their cores do."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.grid_spec import GridSpec
from robotd.grid.tables import NO_INFORMATION
from robotd.grid.wall_field import WallField
from robotd.grid.window import CellWindow
from robotd.localization.judge.error_model import ErrorModel
from robotd.localization.judge.likelihood import Likelihood


@dataclass(frozen=True, slots=True, eq=False)
class Meaning:
    """Evidence, ready to judge poses by and to refine them on."""

    likelihood: Likelihood
    """For the second look."""
    walls: WallField
    """For refinement."""

    @classmethod
    def of(cls, spec: GridSpec, cells: NDArray[np.uint8], blocking: NDArray[np.bool_], errors: ErrorModel) -> "Meaning":
        """Prepare evidence ``uint8[rows, cols]``, and the cells that stop a beam, ``bool[rows, cols]``. O(cells)."""
        # Heads are laid on cells that ended beams; what merely blocks only stops a beam that is cast.
        walls = WallField.of(spec, cells > NO_INFORMATION, blocking)
        return cls(Likelihood.of(spec, cells, errors), walls)

    def updated(self, cells: NDArray[np.uint8], blocking: NDArray[np.bool_], changed: CellWindow) -> "Meaning":
        """Return that of evidence which differs in a window alone; this one stays as it is. O(cells of the window)."""
        walls = self.walls.updated(cells > NO_INFORMATION, blocking, changed)
        return Meaning(self.likelihood.updated(cells, changed), walls)
