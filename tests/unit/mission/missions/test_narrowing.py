"""Narrowing asks whatever estimates, by the protocol alone: in batches, and publishes what is said after each."""

from types import SimpleNamespace
from typing import cast

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Slant
from robotd.grid.occupancy import OccupancyGrid
from robotd.head.desk import Desk
from robotd.head.jobs import Prepare
from robotd.head.near import HeadAtHand
from robotd.head.settings import HeadSettings
from robotd.mission.missions.context import MissionContext
from robotd.mission.missions.localizing import LookRound, Narrowing
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.mission.whereabouts.whereabouts import Whereabouts
from tests.support.living import AtOnce
from tests.support.places import held, place_of, unpaced


class Counting:
    """Says how many readings it was given, and nothing else."""

    def __init__(self) -> None:
        self.taken: list[RangeReading] = []

    def add(self, *readings: RangeReading) -> None:
        self.taken.extend(readings)

    def add_slants(self, *slants: Slant) -> None:
        for slant in slants:
            self.taken.extend(slant.readings)

    def estimate(self, time_ns: int, *, final: bool) -> PoseEstimate:
        return PoseEstimate(time_ns, PoseState.LOST, None, (), 0, len(self.taken), final, "another estimator's")

    def heat(self) -> None:
        return None


async def test_another_estimator_is_asked_after_each_batch_and_given_what_was_measured() -> None:
    published: list[PoseEstimate] = []
    shown: list[int] = []
    head = HeadAtHand(Desk(HeadSettings(), begin=lambda _ready, _job: Counting()), unpaced(AtOnce()))
    here = await place_of(head, OccupancyGrid(held().spec), "m")
    stop = head.number()
    await head.ask(Prepare(stop, here.ref, here.map_id, (0.0,), None))
    context = SimpleNamespace(
        head=head,
        settings=SimpleNamespace(sweep=SweepSettings(readings=10)),
        whereabouts=Whereabouts(),
        robot=SimpleNamespace(has_base=False),
        publish=lambda estimate, made: published.append(estimate),
    )
    narrowing = Narrowing(
        cast("MissionContext", context), stop, 4, LookRound(5, 2), lambda: shown.append(len(published)), ties=True
    )
    narrowing.begun(Pose2(1.0, 2.0, 0.5))
    for number in range(10):
        status = ReadingStatus.WEAK if number == 5 else ReadingStatus.OK
        narrowing.read(RangeReading(number, 0.1 * number, status, None if number == 5 else 1.0))
    narrowing.end()
    last = await narrowing.run()
    assert [(estimate.readings, estimate.final) for estimate in published] == [
        (4, False),
        (7, False),
        (9, False),
        (9, True),
    ]
    # After the estimates of 4 and of 8 of 10 readings, of which one failed, and when all was said.
    assert shown == [1, 2, 4]
    assert last is published[-1]
    assert {estimate.in_odom for estimate in published} == {Pose2(1.0, 2.0, 0.5)}
    assert {(estimate.mission_id, estimate.sweep) for estimate in published} == {(5, 2)}
