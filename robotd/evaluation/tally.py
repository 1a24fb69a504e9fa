"""What the cases of a log come to: shares and percentiles. Memory does not grow with the cases."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from robotd.evaluation.quantiles import Quantiles
from robotd.evaluation.result import Result
from robotd.evaluation.verdict import CaseVerdict


@dataclass(slots=True, eq=False)
class Tally:
    """The cases so far."""

    verdicts: Counter[CaseVerdict] = field(default_factory=Counter)
    ambiguous_with_truth: int = 0
    """Cases that are ambiguous with the truth among the answers."""
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
            whole.ambiguous_with_truth += tally.ambiguous_with_truth
            for name in ("error_m", "error_rad", "cpu_s", "wall_s"):
                getattr(whole, name).merge(getattr(tally, name))
        return whole

    @property
    def cases(self) -> int:
        """How many there are."""
        return self.verdicts.total()

    def add(self, result: Result) -> None:
        """Count one more."""
        self.verdicts[result.verdict] += 1
        self.ambiguous_with_truth += result.verdict is CaseVerdict.AMBIGUOUS and result.has_truth
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
            "error_m": self.error_m.told(),
            "error_rad": self.error_rad.told(),
            "cpu_s": self.cpu_s.told(),
            "wall_s": self.wall_s.told(),
        }
