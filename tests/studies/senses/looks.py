"""Looks round, and what they cost, without devices: the mission's own code chooses, the world answers."""

import random
from collections.abc import Sequence
from types import SimpleNamespace
from typing import cast

from robotd.app.compose import mission_settings
from robotd.config import Config
from robotd.contract.estimate import PoseEstimate
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading
from robotd.head.job import A, Job
from robotd.head.job_table import perform
from robotd.head.jobs import Narrow, Prepare
from robotd.mission.missions.context import MissionContext
from robotd.mission.missions.looking_until_sure import LookingUntilSure
from robotd.mission.missions.sweep_plan import plan_sweep
from robotd.sensing.until_sure import CONTRAST_MIN
from tests.studies.senses.ground import READINGS, Ground, readings_at

_STOP = 1
_PAN_RAD = 2.75
"""So far the head pans to either side."""


class _Head:
    """Array work where it is asked."""

    def __init__(self, ground: Ground) -> None:
        self._ground = ground

    async def ask(self, job: Job[A]) -> A:
        return perform(self._ground.desk, job)


class _Answers:
    """What readings come to, where it is asked."""

    def __init__(self, ground: Ground) -> None:
        self._ground = ground

    def begun(self, in_odom: Pose2) -> None:
        """Nothing has wheels here."""

    async def answer(self, batch: Sequence[RangeReading]) -> PoseEstimate:
        return _narrowed(self._ground, batch, final=False)


async def adaptive_look(ground: Ground, truth: Pose2, draw: random.Random) -> tuple[PoseEstimate, int]:
    """Return what a look until sure comes to, all headings tried, and how many readings it took."""
    config = Config()
    settings = mission_settings(config)
    perform(ground.desk, Prepare(_STOP, ground.map, "m", config.localization.headings_all_round(), None, CONTRAST_MIN))

    context = SimpleNamespace(head=_Head(ground), settings=settings)
    looking = LookingUntilSure(cast("MissionContext", context), ground.map, _Answers(ground))
    taken = 0
    async for bearings in looking.wanted(plan_sweep(READINGS, -_PAN_RAD, _PAN_RAD)):
        for reading in readings_at(ground.world, truth, bearings.bearings_rad, ground.cutoff_m, draw):
            looking.read(reading)
            taken += 1
    return _narrowed(ground, (), final=True), taken


def _narrowed(ground: Ground, batch: Sequence[RangeReading], *, final: bool) -> PoseEstimate:
    measured = tuple(reading for reading in batch if reading.is_measured)
    return perform(ground.desk, Narrow(_STOP, measured, 0, final)).estimate
