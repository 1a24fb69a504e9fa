"""What every job is: data, with a name in recordings and the type of its answer."""

from typing import Any, ClassVar, Generic, TypeVar

import msgspec

A = TypeVar("A")


class Job(msgspec.Struct, Generic[A], frozen=True, forbid_unknown_fields=True):
    """Array work that is answered by an ``A``."""

    name: ClassVar[str]
    answer: ClassVar[Any]
    is_noted: ClassVar[bool] = False
    """Whether a mission goes on by its answer: then the journal notes when it was handed back, and a replay hands it
    back no sooner. What only clients ask for has no effect on the robot, and a replay does not ask for it."""

    @property
    def makes(self) -> "Made | None":
        """What is held once it is done that was not before; None if nothing is."""
        return None

    def again(self, answer: A) -> "Job[Any]":
        """Return what leads to the same in a head that was started again, once this was answered."""
        return self


class Made(msgspec.Struct, frozen=True):
    """Something that came to be held: the first of its number, or what follows from further steps."""

    number: int
    after: int | None
    """How many jobs of its number it follows from: later ones do not count any more. None is all there are."""


class Done(msgspec.Struct, frozen=True):
    """It was done, and there is nothing to say."""
