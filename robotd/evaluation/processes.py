"""A schedule over processes of this machine, which are replaced when they die."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from itertools import islice
from multiprocessing import get_context
from typing import Generic

from robotd.core.errors import RobotdError
from robotd.evaluation.schedule import AHEAD, Answer, Case, Schedule

_DEATHS_MAX = 3
"""A case that processes died of more often is what kills them."""


@dataclass(slots=True, eq=False)
class _UnderWay(Generic[Case, Answer]):
    case: Case
    future: Future[Answer] | None = None
    deaths: int = 0
    """How many processes died of it, or beside it."""

    @property
    def is_answered(self) -> bool:
        return self.future is not None and self.future.done() and self.future.exception() is None


def over_processes(workers: int) -> Schedule:
    """Return a schedule over ``workers`` processes.

    A process that dies (no memory, a signal) costs the time of its case and nothing else. Raises RobotdError where a
    case kills every process it meets.
    """

    def spread(job: Callable[[Case], Answer], cases: Iterable[Case], /) -> Iterator[Answer]:
        window: deque[_UnderWay[Case, Answer]] = deque()
        source = iter(cases)
        while True:
            yield from _until_one_dies(job, source, window, workers)
            if not window:
                return
            if max(under_way.deaths for under_way in window) > _DEATHS_MAX:
                raise RobotdError(f"processes died {_DEATHS_MAX + 1} times over the same cases")

    return spread


def _until_one_dies(
    job: Callable[[Case], Answer], source: Iterator[Case], window: deque[_UnderWay[Case, Answer]], workers: int
) -> Iterator[Answer]:
    """Answer cases; what is under way when a process dies stays in the window."""
    # Spawned: a fork copies locks that threads of this process hold, and nobody would ever let go of them.
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        try:
            while True:
                window.extend(map(_UnderWay, islice(source, AHEAD * workers - len(window))))
                for under_way in window:
                    under_way.future = under_way.future or pool.submit(job, under_way.case)
                if not window:
                    return
                assert window[0].future is not None
                answer = window[0].future.result()
                window.popleft()
                yield answer
        except BrokenProcessPool:
            # Which of them it died of cannot be told: all that have no answer are asked again, and the guilty one is
            # known by its deaths.
            for under_way in window:
                if not under_way.is_answered:
                    under_way.future, under_way.deaths = None, under_way.deaths + 1
        finally:
            pool.shutdown(wait=True, cancel_futures=True)
