"""How a device is recognized on a line of which nothing is known: by one question that moves, lights and sets nothing.

Each dialect says how it is asked, or why nobody asks it: the question may be read by any other device.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Protocol


class Hearing(Protocol):
    """The receiving half of a dialect, as far as it takes to recognize an answer."""

    def feed(self, data: bytes) -> Iterable[Any]:
        """Take bytes as they come; return the messages that are whole now."""


@dataclass(frozen=True, slots=True)
class Enquiry:
    """What is written, and who answers it."""

    data: bytes
    listener: Callable[[], Hearing]
    told: Callable[[Any], str | None]
    """Says in words what a message tells of who sent it; None if it is no answer of such a device."""
    tries: int = 2
    """How often it is asked."""


@dataclass(frozen=True, slots=True)
class NotAsked:
    """No question: nothing is written to find such a device."""

    why: str
    """In a sentence without its end."""
