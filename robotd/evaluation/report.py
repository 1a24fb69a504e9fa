"""What the cases of a log come to: shares, percentiles, and the same as a JSON document."""

import dataclasses
from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np

from robotd.core.pose import Pose2
from robotd.evaluation.verdict import Case, Verdict
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.tables import NO_INFORMATION
from robotd.logs.scan import PoseSource

PERCENTILES = (50, 90, 99, 100)


@dataclass(frozen=True, slots=True, eq=False)
class LogReport:
    """One log, and what became of its cases so far."""

    log: str
    scans: int
    """Scans in the log."""
    map_scans: int
    asked: int
    """Cases there should be; fewer are there if it was interrupted."""
    grid: OccupancyGrid
    cases: tuple[Case, ...]
    poses: PoseSource = PoseSource.LOG
    """Whose poses are taken for the truth."""
    damaged_lines: int = 0
    """Lines of the log that were left out."""

    @property
    def is_cut(self) -> bool:
        """Whether it was interrupted."""
        return len(self.cases) < self.asked

    def share(self, verdict: Verdict) -> float:
        """Return the share of the cases with a verdict; of no case, none."""
        return self._share_of(Counter(case.verdict for case in self.cases)[verdict])

    @property
    def ambiguous_with_truth(self) -> float:
        """Share of the cases that are ambiguous with the truth among the answers."""
        return self._share_of(sum(case.verdict is Verdict.AMBIGUOUS and case.has_truth for case in self.cases))

    def _share_of(self, count: int) -> float:
        return count / len(self.cases) if self.cases else 0.0

    @property
    def failures(self) -> tuple[Case, ...]:
        """The cases that are not right."""
        return tuple(case for case in self.cases if case.verdict is not Verdict.RIGHT)

    @property
    def errors_m(self) -> list[float]:
        """How far the right answers are off."""
        right = (case for case in self.cases if case.verdict is Verdict.RIGHT)
        return [case.error_m for case in right if case.error_m is not None]

    @property
    def errors_rad(self) -> list[float]:
        """How far the right answers are turned."""
        right = (case for case in self.cases if case.verdict is Verdict.RIGHT)
        return [case.error_rad for case in right if case.error_rad is not None]

    def document(self) -> dict[str, Any]:
        """Return all of it for programs."""
        return {
            "log": self.log,
            "scans": self.scans,
            "poses": self.poses.value,
            "damaged_lines": self.damaged_lines,
            "map_scans": self.map_scans,
            "asked": self.asked,
            "cases": len(self.cases),
            "interrupted": self.is_cut,
            **{verdict.value: self.share(verdict) for verdict in Verdict},
            "ambiguous_with_truth": self.ambiguous_with_truth,
            "error_m": percentiles(self.errors_m),
            "error_rad": percentiles(self.errors_rad),
            "cpu_s": percentiles([case.cpu_s for case in self.cases]),
            "wall_s": percentiles([case.wall_s for case in self.cases]),
            "map": _map_facts(self.grid),
            "results": [_case_facts(case) for case in self.cases],
        }


def percentiles(values: list[float]) -> dict[str, float] | None:
    """Return the percentiles that are told, by name; None of nothing.

    >>> percentiles([1.0, 2.0, 3.0])["p50"]
    2.0
    """
    if not values:
        return None
    return {f"p{percent}": float(np.percentile(values, percent)) for percent in PERCENTILES}


def _map_facts(grid: OccupancyGrid) -> dict[str, Any]:
    return {
        "rows": grid.spec.rows,
        "cols": grid.spec.cols,
        "resolution_m": grid.spec.resolution_m,
        "vacant_cells": int((grid.cells < NO_INFORMATION).sum()),
        "occupied_cells": int((grid.cells > NO_INFORMATION).sum()),
        "digest": grid.digest(),
    }


def _case_facts(case: Case) -> dict[str, Any]:
    estimate = case.estimate
    return {
        "scan": case.query.number,
        "verdict": case.verdict.value,
        "has_truth": case.has_truth,
        "truth": _pose_facts(case.truth),
        "best": None if estimate.best is None else _pose_facts(estimate.best),
        "error_m": case.error_m,
        "error_rad": case.error_rad,
        "best_rank": estimate.best_rank,
        "readings": estimate.readings,
        "regions": len(estimate.regions),
        "cpu_s": case.cpu_s,
        "wall_s": case.wall_s,
    }


def _pose_facts(pose: Pose2) -> dict[str, float]:
    return dataclasses.asdict(pose)
