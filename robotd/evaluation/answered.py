"""What an earlier run answered, by the lines that it wrote: a run that was ended goes on where it was."""

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

from robotd.evaluation.map_facts import MapFacts
from robotd.evaluation.result import CaseKey, CaseResult


@dataclass(frozen=True, slots=True, eq=False)
class Answered:
    """Results, found again by their keys; of another program, other settings or another map none has the same key."""

    results: dict[CaseKey, CaseResult] = field(default_factory=dict)
    maps: dict[str, MapFacts] = field(default_factory=dict)
    """What was told of maps, by the digest that results on them have, too."""

    @classmethod
    def of_lines(cls, lines: Iterable[str]) -> "Answered":
        """Read JSON lines; what is neither result nor report is passed over, and so is a line that a kill cut off."""
        answered = cls()
        for document in _documents(lines):
            if "verdict" in document:
                result = CaseResult.of_document(document)
                answered.results[result.key] = result
            elif "map" in document and "settings" in document:
                answered.maps[document["settings"]] = MapFacts.of_document(document["map"])
        return answered


def _documents(lines: Iterable[str]) -> Iterator[dict[str, Any]]:
    for line in lines:
        try:
            document = json.loads(line)
        except ValueError:
            continue
        if isinstance(document, dict):
            yield document
