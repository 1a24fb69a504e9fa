"""Who does array work, as the mission knows it: asked by jobs, answered by small values."""

from collections import Counter
from collections.abc import Callable
from typing import Protocol

from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.counted import Counted
from robotd.head.job import A, Job


class Head(Protocol):
    """Carries out jobs, one at a time, in the order in which they are asked for."""

    def number(self) -> int:
        """Return a number for a map or a stop that no other has, or had."""

    async def ask(self, job: Job[A]) -> A:
        """Return the answer of a job; who is cancelled meanwhile gives it up.

        Raises:
            RobotdError: it cannot be done; says why.
        """

    def forget(self, number: int) -> None:
        """Let go of the map or the stop of a number, soon; nobody asks for it any more."""


class NotedHead:
    """Notes when each job that a mission goes on by was handed back: a replay hands it back no sooner."""

    def __init__(self, inner: Head, note: Callable[[str, int], None], counted: Counted) -> None:
        """Ask ``inner``; how long each answer took goes to ``counted``."""
        self._inner = inner
        self._counted = counted
        self._note = note
        # Counted by name: a replay asks in the same order, so the third of a name is the same job.
        self._done: Counter[str] = Counter()
        self.number = inner.number
        self.forget = inner.forget

    async def ask(self, job: Job[A]) -> A:
        """Return the answer of a job, or raise what it raises, and note that it is done."""
        asked_ns = now_ns()
        try:
            answer = await self._inner.ask(job)
        except Exception:  # that it failed is taken up too, and leads to something
            self._note_next(job)
            raise
        self._note_next(job)
        # Spaces are not for labels.
        self._counted.observe("job_seconds", (now_ns() - asked_ns) / NS_PER_S, job=job.name.replace(" ", "_"))
        return answer

    def _note_next(self, job: Job[A]) -> None:
        if job.is_noted:
            self._note(job.name, self._done[job.name])
            self._done[job.name] += 1
