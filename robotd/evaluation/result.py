"""What is kept of a case: small, the same wherever it was computed, and a line of JSON."""

import dataclasses
from dataclasses import dataclass
from typing import Any

from robotd.contract.estimate import PoseEstimate
from robotd.core.angles import wrap_rad
from robotd.core.pose import Pose2
from robotd.evaluation.verdict import CaseVerdict, has_truth, verdict_on


@dataclass(frozen=True, slots=True)
class CaseKey:
    """By what a result is known: the same key means the same case, and the same answer but for its times."""

    log: str
    scan: int
    """Which scan of the log, in file order, from 0."""
    seed: int
    settings: str
    """Digest of everything that the answer depends on but the log."""
    commit: str
    """Of which program; its version where no commit is known."""


@dataclass(frozen=True, slots=True)
class Result:
    """One case, answered."""

    key: CaseKey
    verdict: CaseVerdict
    has_truth: bool
    """Whether the truth is among the answers."""
    truth: Pose2
    """Where the laser was, map frame."""
    best: Pose2 | None
    answers: tuple[Pose2, ...]
    """The middles of all regions, map frame, the best first."""
    best_rank: int | None
    readings: int
    cpu_s: float
    """Processor time of the answer, of all threads."""
    wall_s: float
    """Time until the answer was there."""

    @classmethod
    def of(cls, key: CaseKey, estimate: PoseEstimate, truth: Pose2, *, cpu_s: float, wall_s: float) -> "Result":
        """Judge an estimate."""
        return cls(
            key,
            verdict_on(estimate, truth),
            has_truth(estimate, truth),
            truth,
            estimate.best,
            tuple(region.centre for region in estimate.regions),
            estimate.best_rank,
            estimate.readings,
            cpu_s,
            wall_s,
        )

    @property
    def error_m(self) -> float | None:
        """How far the answer is from the truth; None without one answer."""
        return None if self.best is None else self.best.distance_m(self.truth)

    @property
    def error_rad(self) -> float | None:
        """How far it is turned."""
        return None if self.best is None else abs(wrap_rad(self.best.heading_rad - self.truth.heading_rad))

    def document(self) -> dict[str, Any]:
        """Return it for programs, flat but for its poses."""
        return {
            **dataclasses.asdict(self.key),
            "verdict": self.verdict.value,
            "has_truth": self.has_truth,
            "truth": dataclasses.asdict(self.truth),
            "best": None if self.best is None else dataclasses.asdict(self.best),
            "error_m": self.error_m,
            "error_rad": self.error_rad,
            "best_rank": self.best_rank,
            "readings": self.readings,
            "regions": len(self.answers),
            "cpu_s": self.cpu_s,
            "wall_s": self.wall_s,
        }
