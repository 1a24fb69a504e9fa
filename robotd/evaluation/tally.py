"""What the cases of a log come to: shares and percentiles. Memory does not grow with the cases."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from robotd.evaluation.quantiles import Quantiles
from robotd.evaluation.result import CaseResult
from robotd.evaluation.verdict import CaseVerdict


@dataclass(slots=True, eq=False)
class Tally:
    """The cases so far."""

    verdicts: Counter[CaseVerdict] = field(default_factory=Counter)
    ambiguous_with_truth: int = 0
    """Cases that are ambiguous with the truth among the answers."""
    near: int = 0
    """Cases near to a scan of the map."""
    near_right: int = 0
    said: Counter[int] = field(default_factory=Counter)
    """Cases by the belief of their best answer, in tenths; without an answer they are not in it."""
    said_right: Counter[int] = field(default_factory=Counter)
    """Those of them whose best answer is right."""
    error_m: Quantiles = field(default_factory=Quantiles)
    """How far the right answers are off."""
    error_rad: Quantiles = field(default_factory=Quantiles)
    """How far the right answers are turned."""
    cpu_s: Quantiles = field(default_factory=Quantiles)
    wall_s: Quantiles = field(default_factory=Quantiles)

    @classmethod
    def of(cls, tallies: Iterable["Tally"]) -> "Tally":
        """Return the tally of the cases of all."""
        whole = cls()
        for tally in tallies:
            whole.verdicts += tally.verdicts
            for name in ("ambiguous_with_truth", "near", "near_right"):
                setattr(whole, name, getattr(whole, name) + getattr(tally, name))
            whole.said += tally.said
            whole.said_right += tally.said_right
            for name in ("error_m", "error_rad", "cpu_s", "wall_s"):
                getattr(whole, name).merge(getattr(tally, name))
        return whole

    @property
    def cases(self) -> int:
        """How many there are."""
        return self.verdicts.total()

    def add(self, result: CaseResult) -> None:
        """Count one more."""
        self.verdicts[result.verdict] += 1
        self.ambiguous_with_truth += result.verdict is CaseVerdict.AMBIGUOUS and result.has_truth
        self.near += result.is_near
        self.near_right += result.is_near and result.verdict is CaseVerdict.RIGHT
        if result.regions:
            # All of the belief belongs to the last tenth.
            tenth = min(int(10 * result.belief), 9)
            self.said[tenth] += 1
            self.said_right[tenth] += result.is_best_right
        self.cpu_s.add(result.cpu_s)
        self.wall_s.add(result.wall_s)
        if result.verdict is CaseVerdict.RIGHT and result.error_m is not None and result.error_rad is not None:
            self.error_m.add(result.error_m)
            self.error_rad.add(result.error_rad)

    def share(self, count: int) -> float:
        """Return what share of the cases a count is; of no case, none."""
        return count / self.cases if self.cases else 0.0

    def document(self) -> dict[str, Any]:
        """Return it for programs."""
        return {
            "cases": self.cases,
            **{verdict.value: self.share(self.verdicts[verdict]) for verdict in CaseVerdict},
            "ambiguous_with_truth": self.share(self.ambiguous_with_truth),
            "near": self.near,
            "near_right": self.near_right,
            "calibration": [
                {"belief": [tenth / 10, (tenth + 1) / 10], "cases": cases, "right": self.said_right[tenth]}
                for tenth, cases in sorted(self.said.items())
            ],
            "error_m": self.error_m.told(),
            "error_rad": self.error_rad.told(),
            "cpu_s": self.cpu_s.told(),
            "wall_s": self.wall_s.told(),
        }
