"""What cases are spread by: in this process, over processes, over a cluster; one protocol for all of them."""

from collections.abc import Callable, Iterable, Iterator
from typing import Protocol, TypeVar

Case = TypeVar("Case")
Answer = TypeVar("Answer")

AHEAD = 4
"""Cases that are under way at a time for each worker, the one that is waited for among them: enough that none is idle
while another is at a dear one."""


class Schedule(Protocol):
    """A ``map``: answers come in the order of the cases, whichever worker is done first.

    No more cases are taken than are under way, so neither they nor the answers pile up. What can be lost to a kill is
    what is under way.
    """

    def __call__(self, job: Callable[[Case], Answer], cases: Iterable[Case], /) -> Iterator[Answer]:
        """Yield the answers.

        Raises:
            RobotdError: of the job, or the schedule cannot go on.
        """
        ...


def in_this_process(job: Callable[[Case], Answer], cases: Iterable[Case], /) -> Iterator[Answer]:
    """Answer one case after the other."""
    return map(job, cases)
