"""A scheduler of this machine: cases in batches, over processes that are replaced when they die."""

from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, replace
from itertools import chain, islice
from multiprocessing import get_context
from typing import Generic, TypeVar

from robotd.core.errors import RobotdError

BATCH = 8
"""Cases sent at a time: a few seconds of work, against a map that is packed once for each batch."""
_DEATHS_MAX = 3
"""A batch that processes died of more often is what kills them."""

Case = TypeVar("Case")
Answer = TypeVar("Answer")


@dataclass(frozen=True, slots=True)
class _Batch(Generic[Case]):
    cases: tuple[Case, ...]
    deaths: int = 0
    """How many processes died of it, or beside it."""


def over_processes(workers: int) -> Callable[[Callable[[Case], Answer], Iterable[Case]], Iterator[Answer]]:
    """Return a ``map`` over ``workers`` processes; results come as they are ready, not in order.

    No more cases are taken than are under way, so neither they nor the results pile up. A process that dies (no memory,
    a signal) costs its batch's time and nothing else. Raises RobotdError where a batch kills every process it meets.
    """

    def spread(job: Callable[[Case], Answer], cases: Iterable[Case]) -> Iterator[Answer]:
        left: deque[_Batch[Case]] = deque()
        source = _batches(cases)
        while True:
            left = yield from _until_one_dies(job, chain(left, source), workers)
            if not left:
                return
            if max(batch.deaths for batch in left) > _DEATHS_MAX:
                raise RobotdError(f"processes died {_DEATHS_MAX + 1} times over the same cases")

    return spread


def _until_one_dies(
    job: Callable[[Case], Answer], batches: Iterator[_Batch[Case]], workers: int
) -> Generator[Answer, None, deque[_Batch[Case]]]:
    """Work through batches, and return those that were under way when a process died."""
    under_way: dict[Future[list[Answer]], _Batch[Case]] = {}
    # Spawned: a fork copies locks that threads of this process hold, and nobody would ever let go of them.
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        try:
            while True:
                # Two a worker: one under way and one at hand, so that none is idle while its answers are read.
                for batch in islice(batches, 2 * workers - len(under_way)):
                    under_way[pool.submit(_answers, job, batch.cases)] = batch
                if not under_way:
                    return deque()
                done, _ = wait(under_way, return_when=FIRST_COMPLETED)
                for future in done:
                    answers = future.result()
                    del under_way[future]  # only now: a batch that killed its process is asked again
                    yield from answers
        except BrokenProcessPool:
            # Which of them it died of cannot be told: all are asked again, and the guilty one is known by its
            # deaths.
            return deque(replace(batch, deaths=batch.deaths + 1) for batch in under_way.values())
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _answers(job: Callable[[Case], Answer], cases: tuple[Case, ...]) -> list[Answer]:
    return [job(case) for case in cases]


def _batches(cases: Iterable[Case]) -> Iterator[_Batch[Case]]:
    iterator = iter(cases)
    while batch := tuple(islice(iterator, BATCH)):
        yield _Batch(batch)
