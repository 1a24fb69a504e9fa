"""A second look at the places that the count of readings left: which is it, and is that sure?

Several places may explain as many readings as the right one ([BrownDonald2000]_ sec. 2.2.1: all of them are the
answer). How well they explain them, by :mod:`.likelihood`, decides most such cases. The rest must
be known as undecided, so every answer is weighed against all others there can be:

- every other place, moved uphill from the shortlist: rivals;
- the poses a little to the side of the best one: where nothing holds it, as along a corridor, one of them is as good;
- nowhere: the robot is not on the map, or the map is no longer true, and readings are what they are in any building.

What is compared is evidence in the sense of Bayes. Readings that say the same count once (:mod:`.patches`), else
twenty beams on one moved chair would be evidence enough against any place.

Belief alone is too sure of itself where two places truly are alike: by luck the map shows one of them a little more
sharply, and over a whole room that adds up to any belief. So a place must also stand out from each other one by its
*contrast*: the sum of what the readings say, by its standard error. No single reading can decide, and no sum of
differences that are as small as such luck. Nowhere is a rival like any other: a small room resembles many.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robotd.contract.estimate import Ends, PoseState
from robotd.grid.readings import Readings
from robotd.grid.tables import NO_INFORMATION
from robotd.localization.judge.climbing import Hill, climb
from robotd.localization.judge.ends import ends_at
from robotd.localization.judge.error_model import ErrorModel
from robotd.localization.judge.likelihood import Likelihood
from robotd.localization.judge.patches import thinned, weights
from robotd.localization.judge.second_look_settings import SecondLookSettings
from robotd.localization.judge.shortlist import near, shortlist

_GLANCE_STEPS = ((0.06, 0.026), (0.03, 0.012))
_GLANCE_MOVES = 2
"""A glance stops short of the top of a hill: its model is blurred (:func:`_blurred`) by as much."""
_CLIMBERS_PER_PLACE = 3
"""Starts that are moved uphill, for each place that will be looked at: several may end on the same hill."""
_LOOK_STEPS = ((0.04, 0.012), (0.02, 0.006), (0.01, 0.003))
_ASIDE_STEPS = ((0.02, 0.006),)
_ASIDE_MOVES = 4
_ASIDE = 1.2
"""What lies beside the best place begins farther away than the place ends, by this factor: by the moves it is given."""
_DIRECTIONS = 16
_TOGETHER_M, _TOGETHER_RAD = 0.1, 0.03
"""Starts that end so near to each other climbed the same hill."""
_ELSEWHERE_M, _ELSEWHERE_RAD = 1.0, 0.35
"""This far away, or turned by this much, a place has the readings on other walls."""
_HOPELESS_SHARE, _HOPELESS = 0.5, 10.0
"""A place so far behind at a glance, for each independent reading and altogether, is not looked at: a glance errs by
far less."""


class LayerView(NamedTuple):
    """Readings at a further tilt, and what that layer of the map says of readings."""

    likelihood: Likelihood
    readings: Readings


@dataclass(frozen=True, slots=True, eq=False)
class SecondLook:
    """What the second look found."""

    state: PoseState
    poses: NDArray[np.float64]
    """``float64[k, 3]``: x, y [m] and heading [rad] of the places that were looked at closely, best first."""
    evidence: NDArray[np.float64]
    """``float64[k]``: how much likelier each place is than being elsewhere, logarithm of the ratio of beliefs."""
    beliefs: NDArray[np.float64]
    """``float64[k]``: share of each place, out of all places, what lies beside the best, and nowhere."""
    aside: float
    """Share of what lies beside the best place: near to 0.5 and above where nothing holds it."""
    nowhere: float
    """Share of being nowhere on the map."""
    contrast: float
    """Least contrast of the best place with any elsewhere on the map, in standard errors; infinite if there is none."""
    ends: Ends | None = None
    """Where the readings end, seen from the best place."""


def second_look(
    likelihood: Likelihood,
    readings: Readings,
    poses: NDArray[np.float64],
    ranks: NDArray[np.integer],
    settings: SecondLookSettings,
    *further: LayerView,
) -> SecondLook:
    """Look closely at the places that poses of high rank stand for.

    Args:
        likelihood: of the map.
        readings: hits and misses.
        poses: ``float64[n, 3]``: x, y [m] and heading [rad]: the best poses of the count and all that come near them.
        ranks: ``[n]``: how many readings each explains.
        settings: what counts as one place, and how sure is sure.
        further: what other layers of the map have to say.

    Depends on nothing but its arguments. O(starts x readings x length of a beam in cells).
    """
    views = (LayerView(likelihood, readings), *further)
    starts = _glance(views, poses[shortlist(poses, ranks, 0.2, 0.07, settings.starts_max)], settings)
    if len(starts) == 0 or len(readings) == 0:
        return SecondLook(PoseState.LOST, np.zeros((0, 3)), np.zeros(0), np.zeros(0), 0.0, 1.0, 0.0)
    # Half a patch apart: nearer ones would share their weight nearly whole, and cost as much as any.
    hill = _hill(views, settings.patch_m, lambda of: thinned(of, settings.patch_m / 2.0, settings.readings_max))
    found, scores = climb(hill, starts, _LOOK_STEPS)
    # After the climb: starts from several sides end on one hill, which must not be its own rival.
    apart = shortlist(found, _in_order(scores), _TOGETHER_M, _TOGETHER_RAD, len(found))
    found, scores = found[apart], scores[apart]
    is_rival = ~near(found, found[0], settings.same_within_m, settings.same_within_rad)
    # The best place is near to itself, and must stay.
    is_rival[0] = True
    found, scores = found[is_rival], scores[is_rival]
    # Climbed as well: a ring of fixed poses would miss the ridge of a corridor by a few centimetres.
    _, aside = climb(hill, _around(found[0], settings), _ASIDE_STEPS, _ASIDE_MOVES)
    # Before any reading, each place has an equal share of the belief that the robot is on the map at all.
    beforehand = math.log(_places(likelihood, settings) * settings.off_map_share / (1.0 - settings.off_map_share))
    to_beat = float(hill.elsewhere.sum()) + beforehand
    # Belief alone was 0.9999 sure of the wrong one of two rooms that are alike (decision 16).
    elsewhere, beside = _contrasts(hill, found)
    with_nowhere = _contrast_with_nowhere(hill, found[0], beforehand)
    on_walls = share_on_walls(likelihood, readings, found[0], settings.on_wall_m)
    least, least_beside = settings.contrast_min, settings.contrast_beside_min
    if on_walls < settings.on_walls_min:
        # Ground that nobody has mapped resembles the step beside a wrong place as well as a wrong place.
        least = least_beside = settings.contrast_off_walls_min
    stands_out = elsewhere >= least and beside >= least_beside and with_nowhere >= settings.contrast_nowhere_min
    weighed = _weigh(found, scores - to_beat, float(aside.max()) - to_beat, settings, stands_out=stands_out)
    return replace(weighed, contrast=elsewhere, ends=ends_at(hill, found[0]))


def _hill(views: Sequence[LayerView], patch_m: float, thin: Callable[[Readings], Readings]) -> Hill:
    """Return what all views say of poses, of each some readings."""
    kept = [thin(view.readings) for view in views]
    together = kept[0]
    for later in kept[1:]:
        together = together.joined(later)
    # Of all together: a wall that is met level and aslant is one wall, and says what it says once.
    shared = np.split(weights(together, patch_m), np.cumsum([len(of) for of in kept])[:-1])
    first, *others = (
        Hill(view.likelihood, view.likelihood.sight(of), share)
        for view, of, share in zip(views, kept, shared, strict=True)
    )
    return replace(first, further=tuple(others))


def _glance(
    views: Sequence[LayerView], starts: NDArray[np.float64], settings: SecondLookSettings
) -> NDArray[np.float64]:
    """Return the starts, moved uphill, that are worth a closer look: with half the sharpness and fewer readings."""
    if len(starts) == 0 or len(views[0].readings) == 0:
        return starts
    blurred = [view._replace(likelihood=view.likelihood.with_model(_blurred(view.likelihood.model))) for view in views]
    hill = _hill(blurred, settings.patch_m, lambda of: thinned(of, settings.patch_m, settings.glance_readings_max))
    highest = np.argsort(-hill.heights(starts), kind="stable")[: _CLIMBERS_PER_PLACE * settings.places_max]
    found, scores = climb(hill, starts[highest], _GLANCE_STEPS, _GLANCE_MOVES)
    hopeless = float(scores.max()) - _HOPELESS_SHARE * hill.all_say - _HOPELESS
    found, scores = found[scores >= hopeless], scores[scores >= hopeless]
    chosen = shortlist(found, _in_order(scores), _TOGETHER_M, _TOGETHER_RAD, settings.places_max)
    best: NDArray[np.float64] = found[chosen]
    return best


def _blurred(model: ErrorModel) -> ErrorModel:
    """Return the model for poses that are a step away from the top of their hill."""
    return replace(model, map_sigma_m=2 * model.map_sigma_m, map_sigma_rad=2 * model.map_sigma_rad)


def _in_order(scores: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return whole numbers that order as the scores do."""
    order: NDArray[np.intp] = np.unique(scores, return_inverse=True)[1]
    return order


def _around(pose: NDArray[np.float64], settings: SecondLookSettings) -> NDArray[np.float64]:
    """Return poses that just are not the same place any more, ``float64[n, 3]``."""
    reach_m, reach_rad = _ASIDE * settings.same_within_m, _ASIDE * settings.same_within_rad
    angles = np.arange(_DIRECTIONS) * (math.tau / _DIRECTIONS)
    moved = reach_m * np.stack((np.cos(angles), np.sin(angles), np.zeros(_DIRECTIONS)), axis=1)
    turned = np.array([[0.0, 0.0, reach_rad], [0.0, 0.0, -reach_rad]])
    around: NDArray[np.float64] = pose + np.concatenate((moved, turned))
    return around


def _places(likelihood: Likelihood, settings: SecondLookSettings) -> float:
    """Return how many places the map has room for, at least one."""
    vacant_m2 = likelihood.vacant_m2
    return max(1.0, vacant_m2 / settings.same_within_m**2 * math.tau / settings.same_within_rad)


def _contrasts(hill: Hill, poses: NDArray[np.float64]) -> tuple[float, float]:
    """Return the least contrast of the first of poses ``float64[n, 3]`` with those elsewhere, and those beside it.

    Vuong's test for which of two models is nearer to the truth (Econometrica 57, 1989), the models being two places,
    and its standard error widened by what all readings have in common: how sharply the map shows a place.
    A pose beside it sees the same walls: what the map has wrong of them is as wrong for both, and widens nothing.
    """
    logs = hill.logs(poses)
    said = logs[0] - logs[1:]
    is_beside = near(poses[1:], poses[0], _ELSEWHERE_M, _ELSEWHERE_RAD)
    # A miss ends on no wall: there is nothing that the map could show more sharply in one place.
    in_common = hill.likelihood.model.map_sharpness_sigma * hill.hits_say
    errors = np.sqrt((said * said).sum(axis=1) + np.where(is_beside, 0.0, in_common**2))
    contrasts = np.divide(said.sum(axis=1), errors, out=np.zeros(len(said)), where=errors > 0.0)
    return float(contrasts[~is_beside].min(initial=math.inf)), float(contrasts[is_beside].min(initial=math.inf))


def _contrast_with_nowhere(hill: Hill, pose: NDArray[np.float64], beforehand: float) -> float:
    """Return the contrast of a pose ``float64[3]`` with being nowhere on the map.

    Of all places of a map one that is wrong is the best, and the more there are, the better it is by chance: what each
    lacks beforehand is taken off. Nowhere has no map that could show it more or less sharply.

    Args:
        hill: the readings.
        pose: the best one.
        beforehand: how much less a place is believed than nowhere before any reading, logarithm.
    """
    said = hill.logs(pose[None])[0] - hill.elsewhere
    error = math.sqrt(float((said * said).sum()))
    return (float(said.sum()) - beforehand) / error if error > 0.0 else 0.0


def share_on_walls(likelihood: Likelihood, readings: Readings, pose: NDArray[np.float64], on_wall_m: float) -> float:
    """Return the share of the hits that end on a wall at a pose ``float64[3]``; 1 without hits. O(readings).

    Of 160 true places in the second halves of four recorded buildings' logs, on maps of the first halves, nine of ten
    have 0.85 and more; of ten that were believed and wrong, two.
    """
    hits = readings[readings.is_hit]
    if len(hits) == 0:
        return 1.0
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    heads_m = hits.heads_m @ np.array([[cos, sin], [-sin, cos]]) + pose[:2]
    spec, cells = likelihood.spec, likelihood.chances.cells
    positions = np.floor(spec.positions_at(heads_m)).astype(np.intp)
    reach = max(1.5, on_wall_m / spec.resolution_m)
    sides = np.arange(-math.floor(reach), math.floor(reach) + 1)
    around = np.array([(row, col) for row in sides for col in sides if math.hypot(row, col) <= reach])
    beside = positions[:, None, :] + around
    inside = ((beside >= 0) & (beside < np.array(spec.shape))).all(axis=2)
    rows, cols = np.where(inside, beside[:, :, 0], 0), np.where(inside, beside[:, :, 1], 0)
    is_on_wall = (inside & (cells[rows, cols] > NO_INFORMATION)).any(axis=1)
    return float(is_on_wall.mean())


def _weigh(
    poses: NDArray[np.float64],
    evidence: NDArray[np.float64],
    aside: float,
    settings: SecondLookSettings,
    *,
    stands_out: bool,
) -> SecondLook:
    """Share the belief among the places, what lies beside the best, and nowhere, whose evidence is 0.

    ``stands_out`` is whether the best place has all the contrast that it must have.
    """
    # Less the greatest: an exponent above 700 overflows, and the shares stay the same.
    powers = np.exp(np.append(evidence, (aside, 0.0)) - max(float(evidence[0]), 0.0))
    shares = powers / powers.sum()
    is_sure = float(shares[0]) >= 1.0 - settings.doubt_max and stands_out
    nowhere = float(shares[-1])
    on_map = PoseState.LOCALIZED if is_sure else PoseState.AMBIGUOUS
    # More likely nowhere than anywhere: then no region is told, however good it looks beside the others.
    state = PoseState.LOST if nowhere > 0.5 else on_map
    return SecondLook(state, poses, evidence, shares[:-2], float(shares[-2]), nowhere, math.inf)
