"""What is kept of a case: small, the same wherever it was computed, and a line of JSON."""

import dataclasses
from dataclasses import dataclass
from typing import Any

from robotd.contract.estimate import PoseEstimate
from robotd.core.angles import wrap_rad
from robotd.core.pose import Pose2
from robotd.evaluation.division import Query
from robotd.evaluation.verdict import CaseVerdict, has_truth, is_near, verdict_on


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
    protocol: str
    """How the log was divided, and what was done to the map."""


@dataclass(frozen=True, slots=True)
class CaseResult:
    """One case, what was estimated for it, and how far off that is."""

    key: CaseKey
    verdict: CaseVerdict
    has_truth: bool
    """Whether the truth is among the answers."""
    is_near: bool
    """Whether a scan of the map was taken nearby."""
    truth: Pose2 | None
    """Where the laser was, map frame; None if it was not on this map."""
    belief: float
    """Share of the belief that the best answer has; 0 without one."""
    is_best_right: bool
    """Whether the best answer is right, however sure of it."""
    best: Pose2 | None
    regions: int
    """How many answers there are."""
    answers: tuple[Pose2, ...]
    """The middles of all regions, map frame, the best first; none of a result that was read from a line."""
    best_rank: int | None
    readings: int
    cpu_s: float
    """Processor time of the answer, of all threads."""
    wall_s: float
    """Time until the answer was there."""

    @classmethod
    def of(cls, key: CaseKey, query: Query, estimate: PoseEstimate, *, cpu_s: float, wall_s: float) -> "CaseResult":
        """Judge an estimate."""
        truth, first = query.truth, estimate.regions[0] if estimate.regions else None
        return cls(
            key=key,
            verdict=verdict_on(estimate, truth),
            has_truth=has_truth(estimate, truth),
            is_near=query.is_near,
            truth=truth,
            belief=0.0 if first is None else first.belief,
            is_best_right=first is not None and truth is not None and is_near(first.pose, truth),
            best=estimate.best,
            regions=len(estimate.regions),
            answers=tuple(region.centre for region in estimate.regions),
            best_rank=estimate.best_rank,
            readings=estimate.readings,
            cpu_s=cpu_s,
            wall_s=wall_s,
        )

    @property
    def error_m(self) -> float | None:
        """How far the answer is from the truth; None without either."""
        return None if self.best is None or self.truth is None else self.best.distance_m(self.truth)

    @property
    def error_rad(self) -> float | None:
        """How far it is turned."""
        if self.best is None or self.truth is None:
            return None
        return abs(wrap_rad(self.best.heading_rad - self.truth.heading_rad))

    def document(self) -> dict[str, Any]:
        """Return it for programs, flat but for its poses."""
        return {
            **dataclasses.asdict(self.key),
            "verdict": self.verdict.value,
            "has_truth": self.has_truth,
            "is_near": self.is_near,
            "truth": None if self.truth is None else dataclasses.asdict(self.truth),
            "belief": self.belief,
            "is_best_right": self.is_best_right,
            "best": None if self.best is None else dataclasses.asdict(self.best),
            "error_m": self.error_m,
            "error_rad": self.error_rad,
            "best_rank": self.best_rank,
            "readings": self.readings,
            "regions": self.regions,
            "cpu_s": self.cpu_s,
            "wall_s": self.wall_s,
        }

    @classmethod
    def of_document(cls, document: dict[str, Any]) -> "CaseResult":
        """Return the result that a line told.

        Raises:
            KeyError: it is no document of a result.
        """
        key = CaseKey(**{field.name: document[field.name] for field in dataclasses.fields(CaseKey)})
        truth, best = (None if document[name] is None else Pose2(**document[name]) for name in ("truth", "best"))
        told = (
            "has_truth",
            "is_near",
            "belief",
            "is_best_right",
            "best_rank",
            "readings",
            "regions",
            "cpu_s",
            "wall_s",
        )
        others = {name: document[name] for name in told}
        return cls(key=key, verdict=CaseVerdict(document["verdict"]), truth=truth, best=best, answers=(), **others)
