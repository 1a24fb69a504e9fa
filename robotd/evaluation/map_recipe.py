"""What the map of a log is made of, and how: sent in place of the map, and known without making it."""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass

from robotd.evaluation.degrade import Degraded, degrade
from robotd.evaluation.recorded import Reach, map_of
from robotd.grid.settings import GridSettings
from robotd.logs.scan import Scan


@dataclass(frozen=True, slots=True, eq=False)
class MapRecipe:
    """Scans laid in where the log has them, and what is done to the map then."""

    scans: tuple[Scan, ...]
    reach: Reach
    grid: GridSettings
    kind: str | None
    """What is done to it, of :data:`~robotd.evaluation.degrade.KINDS`; None for nothing."""
    seed: int
    """Of what is random in that."""

    def made(self) -> Degraded:
        """Make the map.

        Raises:
            ValueError: it would be larger than any map.
        """
        grid = map_of(self.scans, self.reach, self.grid)
        return Degraded(grid) if self.kind is None else degrade(self.kind, grid, self.seed)

    def digest(self) -> str:
        """Return what changes with anything that the map depends on."""
        said = hashlib.sha256(f"{self.reach} {self.grid} {self.kind} {self.seed}".encode())
        for part in self._bytes():
            said.update(part)
        return said.hexdigest()

    def _bytes(self) -> Iterator[bytes]:
        for scan in self.scans:
            yield f"{scan.laser_pose} {len(scan.angles_rad)}".encode()
            yield from (column.tobytes() for column in (scan.angles_rad, scan.ranges_m, scan.hit, scan.missed))
