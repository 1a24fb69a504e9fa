"""What is told of a map that cases were sought on."""

from dataclasses import dataclass
from typing import Any

from robotd.core.grid_spec import GridSpec
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION


@dataclass(frozen=True, slots=True)
class MapFacts:
    """What is told of the map that the cases were sought on."""

    spec: GridSpec
    vacant_cells: int
    occupied_cells: int
    digest: str

    @classmethod
    def of(cls, grid: OccupancyGrid) -> "MapFacts":
        """Count its cells."""
        vacant, occupied = int((grid.cells < NO_INFORMATION).sum()), int((grid.cells > NO_INFORMATION).sum())
        return cls(grid.spec, vacant, occupied, grid.digest())

    def document(self) -> dict[str, Any]:
        """Return it for programs."""
        return {
            "rows": self.spec.rows,
            "cols": self.spec.cols,
            "resolution_m": self.spec.resolution_m,
            "vacant_cells": self.vacant_cells,
            "occupied_cells": self.occupied_cells,
            "digest": self.digest,
        }

    @classmethod
    def of_document(cls, document: dict[str, Any]) -> "MapFacts":
        """Return the facts that a line told, but for where the map lies, which none tells.

        Raises:
            KeyError: it is no document of a map.
        """
        spec = GridSpec(document["resolution_m"], 0.0, 0.0, (document["rows"], document["cols"]))
        return cls(spec, document["vacant_cells"], document["occupied_cells"], document["digest"])
