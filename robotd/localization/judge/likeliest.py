"""One look from several: where a map may mean more than one thing, the sweep says which.

Thick walls stand where they are drawn, or somewhere inside (:mod:`.wall_cores`). All walls of a map were drawn by one
pen, so one answer holds for all readings, and a whole sweep weighs both: the right one by far.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from robotd.contract.estimate import PoseState
from robotd.grid.readings import Readings
from robotd.localization.judge.likelihood import Likelihood
from robotd.localization.judge.second_look import LayerView, SecondLook, second_look
from robotd.localization.judge.second_look_settings import SecondLookSettings
from robotd.localization.judge.shortlist import near


def likeliest_look(
    likelihoods: Sequence[Likelihood],
    readings: Readings,
    poses: NDArray[np.float64],
    ranks: NDArray[np.integer],
    settings: SecondLookSettings,
    *further: LayerView,
) -> tuple[int, SecondLook]:
    """Take a second look on everything that a map may mean, and return which has the greatest evidence, and its look.

    That is no longer sure if another one's best place is another place, and is not so unlikely as to leave no doubt.

    Args:
        likelihoods: of what the map may mean, at least one.
        readings: as of :func:`.second_look`, as are the other arguments.
        poses: see there.
        ranks: see there.
        settings: see there.
        further: see there.
    """
    looks = [second_look(likelihood, readings, poses, ranks, settings, *further) for likelihood in likelihoods]
    # Of equal ones the first: walls as they are drawn.
    number = max(range(len(looks)), key=lambda number: _evidence(looks[number]))
    first = looks[number]
    doubt = any(_contradicts(other, first, settings) for other in looks)
    return number, replace(first, state=PoseState.AMBIGUOUS) if doubt and first.state is PoseState.LOCALIZED else first


def _evidence(look: SecondLook) -> float:
    return float(look.evidence.max(initial=-np.inf))


def _contradicts(other: SecondLook, first: SecondLook, settings: SecondLookSettings) -> bool:
    """Whether another look finds another place that may not be left out of account."""
    if len(other.poses) == 0:
        return False
    is_same = near(other.poses[:1], first.poses[0], settings.same_within_m, settings.same_within_rad)[0]
    return not is_same and _evidence(other) - _evidence(first) > np.log(settings.doubt_max)
