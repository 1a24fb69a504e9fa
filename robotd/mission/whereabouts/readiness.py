"""What localization has made of the map in use: kept, so that a changed map is not made ready from nothing."""

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

    def hand_over(self) -> tuple[ReadyMap | None, CellWindow]:
        """Return what :func:`made_ready` begins with, and where the map changed since; hand its result to :meth:`keep`.

        If nobody comes back with a result, because the mission was stopped, the next job begins where this one did.
        """
        ready, changed = self.ready, self.handed_over.joined(self.changed)
        self.handed_over, self.changed = changed, _NOTHING
        return ready, changed

    def keep(self, ready: ReadyMap) -> None:
        """Take over what a job has made."""
        self.ready, self.handed_over = ready, _NOTHING


def made_ready(
    grid: OccupancyGrid,
    settings: LocalizationSettings,
    errors: ErrorModel,
    before: ReadyMap | None,
    changed: CellWindow,
) -> ReadyMap:
    """Return a grid made ready: from nothing, or from what was ready before and where it changed since."""
    return _made(grid, settings, errors) if before is None else before.updated(grid, changed)


def _made(grid: OccupancyGrid, settings: LocalizationSettings, errors: ErrorModel) -> ReadyMap:
    return ReadyMap.of(grid, settings, errors)
