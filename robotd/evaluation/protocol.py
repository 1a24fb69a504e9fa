"""A protocol as typed: how a log is divided, whose map it is asked of, and what is done to that map."""

from dataclasses import dataclass, replace

from robotd.evaluation.degrade import KINDS, degrade
from robotd.evaluation.division import Division, elsewhere, halves, interleaved
from robotd.evaluation.recorded import Reach, map_of
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.settings import GridSettings
from robotd.logs.scan import RecordedLog


@dataclass(frozen=True, slots=True, eq=False)
class Protocol:
    """One way to ask."""

    name: str
    """As typed: ``interleaved``, ``half``, ``other=LOG`` or ``degrade=KIND``."""
    building: RecordedLog | None = None
    """Whose map it is asked of, if it is another's."""

    @property
    def kind(self) -> str | None:
        """What is done to the map, if anything."""
        word, _, kind = self.name.partition("=")
        return kind if word == "degrade" else None

    def map_and_queries(
        self, log: RecordedLog, reach: Reach, settings: GridSettings, *, cases: int, seed: int
    ) -> tuple[OccupancyGrid, Division]:
        """Make the map, and draw what is asked of it.

        Raises:
            ValueError: the map would be larger than any map.
        """
        division = self._divide(log, cases, seed)
        grid = map_of(division.map_scans, reach, settings)
        if self.kind is None:
            return grid, division
        worse = degrade(self.kind, grid, seed)
        # The truth moves with the map: a map that is turned or scaled has its places elsewhere.
        moved = (
            replace(query, truth=None if query.truth is None else worse.pose(query.truth)) for query in division.queries
        )
        return worse.grid, Division(division.map_scans, tuple(moved))

    def _divide(self, log: RecordedLog, cases: int, seed: int) -> Division:
        if self.building is not None:
            return elsewhere(log, self.building, cases, seed)
        return halves(log, cases, seed) if self.name == "half" else interleaved(log, cases, seed)


WORDS = ("interleaved", "half", "other=LOG", *(f"degrade={kind}" for kind in KINDS))
"""What may be typed."""


def checked_word(text: str) -> str:
    """Return the word of a protocol.

    Raises:
        ValueError: there is none; lists all.
    """
    if text in WORDS or (text.startswith("other=") and text != "other="):
        return text
    raise ValueError(f"expected one of {', '.join(WORDS)}, got {text!r}")
