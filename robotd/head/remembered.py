"""What must be done once more in a head that was started again, so that it holds what the one before it held.

A map is its stops (decision 29): its beginning, packed, and the sweeps that were laid in since, in order. A stop is its
readings. So nothing of a head has to be saved: it is fed the same again, and comes to the same, which is looked at.
"""

import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from robotd.core.errors import ChildError
from robotd.head.job import Job
from robotd.head.jobs import HeldMap, Inserted
from robotd.head.wire import pack_job, unpack_answer

_QUICK = 1
"""Level of zlib: 300 readings are 40 KB of numbers with names, a tenth of that packed."""
_PACKED_ALREADY = 2**18
"""Bytes of a job; what is more is a map, whose cells are packed: once more would only keep the loop, for 0.2 s."""


@dataclass(frozen=True, slots=True)
class RememberedStep:
    """A job to be done again. Kept as bytes: a thousand sweeps would be some hundred thousand objects."""

    kind: type[Job[Any]]
    _kept: bytes
    digest: str | None
    """Of the map that it leads to; None if it leads to none."""
    _is_packed: bool

    @classmethod
    def of(cls, job: Job[Any], answer: object) -> "RememberedStep":
        """Return what leads to the same as a job that was answered."""
        again = job.again(answer)
        digest = answer.digest if isinstance(answer, HeldMap | Inserted) else None
        data = pack_job(again)
        is_packed = len(data) < _PACKED_ALREADY
        return cls(type(again), zlib.compress(data, _QUICK) if is_packed else data, digest, is_packed)

    @property
    def data(self) -> bytes:
        """The job as bytes."""
        return zlib.decompress(self._kept) if self._is_packed else self._kept

    def check(self, answer: bytes | memoryview) -> None:
        """Refuse an answer that is not what it was; ChildError says so."""
        found = unpack_answer(self.kind, answer)
        if self.digest is not None and getattr(found, "digest", None) != self.digest:
            raise ChildError("it came to another map than the one before it")


class Memory:
    """The steps that lead to everything that is held, by its number."""

    def __init__(self) -> None:
        self._steps: dict[int, list[RememberedStep]] = {}

    def note(self, job: Job[Any], answer: object) -> None:
        """Take note that a job was answered."""
        made = job.makes
        if made is None:
            return
        steps = self._steps.setdefault(made.number, [])
        # An insertion into a generation that others followed: those were given up, with the mission that made them.
        del steps[len(steps) if made.after is None else made.after :]
        steps.append(RememberedStep.of(job, answer))

    def forget(self, number: int) -> None:
        """Hold what has this number no longer."""
        self._steps.pop(number, None)

    def __contains__(self, number: int) -> bool:
        """Whether something of this number is held."""
        return number in self._steps

    def __iter__(self) -> Iterator[RememberedStep]:
        """Return the steps in the order in which they must be done: a stop comes after the map that it is on."""
        # Numbers only grow, and a stop is begun on a map that is there: so their order is one in which it can
        # be done.
        return (step for number in sorted(self._steps) for step in self._steps[number])
