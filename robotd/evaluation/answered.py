"""Cases that an earlier run answered, by the lines that it wrote: a run that was ended goes on where it was."""

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from robotd.evaluation.result import CaseKey, CaseResult


@dataclass(frozen=True, slots=True, eq=False)
class Answered:
    """Results, found again by their keys; of another program, other settings or another map none has the same key."""

    results: dict[CaseKey, CaseResult]

    @classmethod
    def of_lines(cls, lines: Iterable[str]) -> "Answered":
        """Read JSON lines; what is no result is passed over, and so is a line that a kill cut off."""
        results = map(CaseResult.of_document, _documents(lines))
        return cls({result.key: result for result in results})

    def part(self, keys: Iterable[CaseKey]) -> dict[CaseKey, CaseResult]:
        """Return those of some cases."""
        return {key: self.results[key] for key in keys if key in self.results}


def _documents(lines: Iterable[str]) -> Iterator[dict[str, Any]]:
    for line in lines:
        try:
            document = json.loads(line)
        except ValueError:
            continue
        if isinstance(document, dict) and "verdict" in document:
            yield document
