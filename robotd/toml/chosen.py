"""A section that is one of several dataclasses, as one of its keys says: what a device speaks decides its options."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, cast


@dataclass(frozen=True, slots=True)
class ChosenBy:
    """Stands in the type of a field, as in ``Annotated[DriveSettings, ChosenBy("dialect", {"board": ...})]``."""

    key: str
    kinds: Mapping[str, type[Any]]

    def kind(self, word: object) -> type[Any] | None:
        """Return the dataclass that a word chooses; None if there is none."""
        return self.kinds.get(word) if isinstance(word, str) else None

    def owners(self, name: str) -> dict[str, object]:
        """Return the words whose dataclass has a field, each with the default that the field has there."""
        found = {word: _defaults(kind) for word, kind in self.kinds.items()}
        return {word: defaults[name] for word, defaults in found.items() if name in defaults}


def chosen_in(hint: Any) -> ChosenBy | None:
    """Return how a type is chosen, if it is."""
    return next((item for item in getattr(hint, "__metadata__", ()) if isinstance(item, ChosenBy)), None)


def _defaults(kind: type[Any]) -> dict[str, object]:
    return {item.name: item.default for item in dataclasses.fields(cast("Any", kind))}
