"""One log and what its cases come to."""

from dataclasses import dataclass
from typing import Any

from robotd.evaluation.map_facts import MapFacts
from robotd.evaluation.tally import Tally
from robotd.logs.scan import PoseSource


@dataclass(frozen=True, slots=True, eq=False)
class LogReport:
    """One log, and what became of its cases so far."""

    log: str
    protocol: str
    settings: str
    """Digest of everything that the answers depend on but the log, as in their keys."""
    scans: int
    """Scans in the log."""
    map_scans: int
    asked: int
    """Cases there should be; fewer are there if it was interrupted."""
    map: MapFacts
    tally: Tally
    poses: PoseSource = PoseSource.LOG
    """Whose poses are taken for the truth."""
    damaged_lines: int = 0
    """Lines of the log that were left out."""

    @property
    def name(self) -> str:
        """The log, and how it was asked if not as usual."""
        return f"{self.log} {self.protocol}" if self.protocol != "interleaved" else self.log

    @property
    def is_cut(self) -> bool:
        """Whether it was interrupted."""
        return self.tally.cases < self.asked

    def document(self) -> dict[str, Any]:
        """Return it for programs."""
        return {
            "log": self.log,
            "protocol": self.protocol,
            "settings": self.settings,
            "scans": self.scans,
            "poses": self.poses.value,
            "damaged_lines": self.damaged_lines,
            "map_scans": self.map_scans,
            "asked": self.asked,
            "interrupted": self.is_cut,
            **self.tally.document(),
            "map": self.map.document(),
        }
