"""Narrowing asks whatever estimates, by the protocol alone: in batches, and publishes what is said after each."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, cast

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.core.pose import IDENTITY
from robotd.core.reading import RangeReading, ReadingStatus
from robotd.localization.estimator import Estimator
from robotd.mission.missions.context import MissionContext
from robotd.mission.missions.localizing import Narrowing


class Counting:
    """Says how many readings it was given, and nothing else."""

    def __init__(self) -> None:
        self.taken: list[RangeReading] = []

    def add(self, *readings: RangeReading) -> None:
        self.taken.extend(readings)

    def estimate(self, time_ns: int, *, final: bool) -> PoseEstimate:
        return PoseEstimate(time_ns, PoseState.LOST, None, (), 0, len(self.taken), final, "another estimator's")


class Inline:
    """Computes at once."""

    async def run(self, name: str, function: Callable[..., Any], *arguments: Any) -> Any:  # as Compute
        return function(*arguments)


async def test_another_estimator_is_asked_after_each_batch_and_given_what_was_measured() -> None:
    published: list[PoseEstimate] = []
    context = SimpleNamespace(
        compute=Inline(),
        whereabouts=SimpleNamespace(said=lambda estimate: None),
        robot=SimpleNamespace(has_base=False),
        publish=lambda estimate, made: published.append(estimate),
    )
    estimator: Estimator = Counting()
    narrowing = Narrowing(cast("MissionContext", context), estimator, 4)
    for number in range(10):
        status = ReadingStatus.WEAK if number == 5 else ReadingStatus.OK
        narrowing.offer(RangeReading(number, 0.1 * number, status, None if number == 5 else 1.0))
    narrowing.end(IDENTITY)
    last = await narrowing.run()
    assert [(estimate.readings, estimate.final) for estimate in published] == [
        (4, False),
        (7, False),
        (9, False),
        (9, True),
    ]
    assert last is published[-1]
