"""A head in this process, for replays and tests: the same desk, spoken to by the same bytes."""

import itertools

from robotd.head.answering import answer_to
from robotd.head.compute import Compute
from robotd.head.desk import Desk
from robotd.head.job import A, Job
from robotd.head.wire import pack_job, unpack_answer


class HeadAtHand:
    """Hands jobs to somebody who computes."""

    def __init__(self, desk: Desk, compute: Compute) -> None:
        self._desk = desk
        self._compute = compute
        self._numbers = itertools.count(1)

    def number(self) -> int:
        """Return the next number."""
        return next(self._numbers)

    def forget(self, number: int) -> None:
        """Let go of it."""
        self._desk.forget(number)

    async def ask(self, job: Job[A]) -> A:
        """Return the answer of a job, see :class:`robotd.head.head.Head`."""
        # Through bytes also here: what cannot be sent, or is shared by mistake, shows in tests and replays,
        # too.
        data = pack_job(job)
        # A replay hands back what was noted when it was noted; of the rest it knows no time, and waits for none.
        if job.is_noted:
            return unpack_answer(type(job), await self._compute.run(job.name, answer_to, self._desk, data))
        return unpack_answer(type(job), answer_to(self._desk, data))
