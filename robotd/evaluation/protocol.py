"""A protocol as typed: how a log is divided, whose map it is asked of, and what is done to that map."""

from dataclasses import dataclass

from robotd.evaluation.degrade import KINDS
from robotd.evaluation.division import Cut, Division, elsewhere, halves, interleaved
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

    def divide(self, log: RecordedLog, cases: int, seed: int) -> Division:
        """Draw what makes the map, and what is asked of it."""
        if self.building is not None:
            return elsewhere(log, self.building, cases, seed)
        return halves(log, cases, seed) if self.name == "half" else interleaved(log, cases, seed)

    def asked(self, scans: int, cases: int) -> int:
        """Return how many scans of a log of this length are asked, without drawing them."""
        cut = Cut.halves(scans) if self.name == "half" else Cut.interleaved(scans)
        return min(cases, len(cut.to_ask))


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
