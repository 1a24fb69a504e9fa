"""What localization has made of the map in use: kept, so that a changed map is not made ready from nothing."""

from collections.abc import Callable
from dataclasses import dataclass

from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.window import CellWindow
from robotd.localization.judge.error_model import ErrorModel
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings

_NOTHING = CellWindow(0, 0, 0, 0)


@dataclass(slots=True)
class Readiness:
    """The ready map, if there is one, and where the map changed since."""

    ready: ReadyMap | None = None
    changed: CellWindow = _NOTHING
    """Since a job was handed over."""
    handed_over: CellWindow = _NOTHING
    """What that job takes in; it is not in ``ready`` yet, and never will be if the job's mission is stopped."""

    def note(self, changed: CellWindow) -> None:
        """Take note that cells changed."""
        self.changed = self.changed.joined(changed)

    def hand_over(
        self, grid: OccupancyGrid, settings: LocalizationSettings, errors: ErrorModel
    ) -> Callable[[], ReadyMap]:
        """Return the job that makes the map ready; hand its result to :meth:`keep`.

        If nobody comes back with a result, because the mission was stopped, the next job begins where this one did.
        """
        ready, changed = self.ready, self.handed_over.joined(self.changed)
        self.handed_over, self.changed = changed, _NOTHING
        return lambda: _made(grid, settings, errors) if ready is None else ready.updated(grid, changed)

    def keep(self, ready: ReadyMap) -> None:
        """Take over what a job has made."""
        self.ready, self.handed_over = ready, _NOTHING


def _made(grid: OccupancyGrid, settings: LocalizationSettings, errors: ErrorModel) -> ReadyMap:
    return ReadyMap.of(grid, settings, errors)
