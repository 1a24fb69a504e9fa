"""Where a sweep was taken, on a map that is young and where odometry has a word: placing one stop after the other.

What a map in the making says is weighed, never obeyed: in a corridor nothing on it tells how far the robot has come, so
what is found is fused with what odometry says, each by its covariance. Five things may come of it (:class:`Outcome`).
"""

import functools
import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from robotd.contract.area import Area
from robotd.contract.estimate import PoseState
from robotd.core.angles import wrap_rad
from robotd.core.pose import Pose2
from robotd.grid.occupancy import OccupancyGrid
from robotd.grid.readings import Readings
from robotd.grid.ternary import TernaryMap
from robotd.grid.wall_field import WallField
from robotd.localization.fit.agreement import Agreement, agreement
from robotd.localization.fit.refinement import PoseBox
from robotd.localization.fit.refinement_settings import RefinementSettings
from robotd.localization.fit.ridge import ridge_of
from robotd.localization.fit.tracking import NotHere, Tracked, TrackingSettings, track
from robotd.localization.localizer import Localizer
from robotd.localization.outcome import Outcome
from robotd.localization.ready_map import ReadyMap
from robotd.localization.settings import LocalizationSettings


@dataclass(frozen=True, slots=True, eq=False)
class Believed:
    """A pose and how sure it is."""

    pose: Pose2
    """Map frame."""
    covariance: NDArray[np.float64]
    """``float64[3, 3]`` of x, y [m] and heading [rad], map frame."""

    @property
    def deviation_m(self) -> float:
        """Of the place, along the worse axis of the map."""
        return math.sqrt(max(self.covariance[0, 0], self.covariance[1, 1]))

    @property
    def deviation_rad(self) -> float:
        """Of the heading."""
        return math.sqrt(self.covariance[2, 2])

    def disbelief(self, pose: Pose2) -> float:
        """Return how far off a pose lies: half its squared distance in standard deviations."""
        off = self._off(pose)
        return float(off @ np.linalg.solve(self.covariance, off)) / 2.0

    def no_surer(self, than_m: float, than_rad: float) -> "Believed":
        """Return it with that much more doubt: who claims too much turns robust weights against the truth."""
        return Believed(self.pose, self.covariance + np.diag([than_m**2, than_m**2, than_rad**2]))

    def fused(self, measured: Pose2, covariance: NDArray[np.float64]) -> "Believed":
        """Return it after a measurement: each has a say by how sure it is, in each direction."""
        # As a Kalman filter takes a measurement: in a corridor the map has a say across it and odometry along
        # it.
        gain = self.covariance @ np.linalg.inv(self.covariance + covariance)
        x_m, y_m, turned_rad = (gain @ self._off(measured)).tolist()
        pose = Pose2(self.pose.x_m + x_m, self.pose.y_m + y_m, wrap_rad(self.pose.heading_rad + turned_rad))
        left = (np.eye(3) - gain) @ self.covariance
        # Made symmetric again: rounding takes that away bit by bit, and stop after stop builds on it.
        return Believed(pose, (left + left.T) / 2.0)

    def _off(self, pose: Pose2) -> NDArray[np.float64]:
        """Return by how much a pose differs, along the axes of the map, ``float64[3]``."""
        turned_rad = wrap_rad(pose.heading_rad - self.pose.heading_rad)
        return np.array((pose.x_m - self.pose.x_m, pose.y_m - self.pose.y_m, turned_rad))


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """What came of it, and where the sweep is then believed to have been taken."""

    outcome: Outcome
    believed: Believed
    agreement: Agreement
    """Of the map with the sweep at the best pose that was found on it."""


@dataclass(frozen=True, slots=True)
class PlacingSettings:
    """When a map explains a sweep, and how far around odometry's word it is looked for. The same for all buildings."""

    box_sigmas: float = 2.5
    near_sigmas: float = 1.0
    box_m: float = 0.05
    ridge_rad: float = 0.05
    """How far the heading of what was found is doubted when others beside it are asked."""
    far_gain: float = 0.05
    """What a place must be worth more than one nearer to odometry's, times how much less odometry believes in it."""
    sure_share: float = 0.6
    """Where a place explains this share of a sweep, none nearer is asked for."""
    placed_consent: float = 0.7
    placed_share: float = 0.3
    """Through a doorway a sweep of the next room is explained in part, and in part it is by the first one's walls."""
    weak_consent: float = 0.5
    weak_factor: float = 4.0
    """A sweep that is explained in part has a covariance greater by this factor."""
    weak_m: float = 0.25
    weak_rad: float = math.radians(10.0)
    """What is explained in part is believed only where odometry is no less sure than this: over a wide box some pose
    always explains half of a sweep."""
    told_share: float = 0.4
    """Where the map says something of fewer readings, the ground is new."""
    new_ground_factor: float = 2.0
    wide_m: float = 2.5
    wide_rad: float = math.radians(45.0)
    wide_sigmas: float = 2.0
    wide_share: float = 0.4
    """What a pose must explain to be asked whether it is the place; see ``localized_share``."""
    wide_gain: float = 0.02
    readings_min: int = 12
    """With fewer readings nothing is looked for."""
    tracking: TrackingSettings = field(default_factory=TrackingSettings)
    refinement: RefinementSettings = field(default_factory=RefinementSettings)


@dataclass(frozen=True, eq=False)
class Ground:
    """A map to place sweeps on; what is seldom needed is made when it is."""

    grid: OccupancyGrid
    localization: LocalizationSettings

    @functools.cached_property
    def ternary(self) -> TernaryMap:
        """In three values."""
        return TernaryMap.from_grid(self.grid)

    @functools.cached_property
    def walls(self) -> WallField:
        """Walls alone block: unknown cells are holes as often as not on a map of few stops."""
        return WallField.of(self.ternary.spec, self.ternary.occupied, self.ternary.occupied)

    @functools.cached_property
    def ready(self) -> ReadyMap:
        """For the search."""
        return ReadyMap.of(self.grid, self.localization)

    def agreement(self, readings: Readings, pose: Pose2) -> Agreement:
        """Return what it says of a sweep at a pose."""
        return agreement(self.walls, self.ternary.vacant, readings, pose)


def place(ground: Ground, readings: Readings, prior: Believed, settings: PlacingSettings) -> Placed:
    """Return where a sweep was taken.

    Args:
        ground: the map, of stops near by.
        readings: the sweep.
        prior: odometry's word, carried on from the last stop.
        settings: when it is explained.
    """
    near = near_prior(ground, readings, prior, settings)
    if near is None:
        nothing = np.zeros(len(readings), np.bool_)
        return Placed(Outcome.NEW_GROUND, _widened(prior, settings), Agreement(nothing, nothing))
    found, agreed = near
    # The box first: only what it leaves unexplained is worth the search of a disk.
    if is_explained(agreed, settings):
        return Placed(Outcome.PLACED, prior.fused(found.pose, found.covariance), agreed)
    wide = _wide(ground, readings, prior, settings)
    if wide is not None and _worth(wide[1], settings) > _worth(agreed, settings) + settings.wide_gain:
        found, agreed = wide
        # Odometry was wrong by more than it errs: it has no say in where.
        return Placed(Outcome.WIDE, Believed(found.pose, found.covariance), agreed)
    told = agreed.explained_share + agreed.contradicted_share
    # Asked after the wide search: new ground may be a known room that odometry has missed.
    if told < settings.told_share:
        return Placed(Outcome.NEW_GROUND, _widened(prior, settings), agreed)
    is_narrow = prior.deviation_m <= settings.weak_m and prior.deviation_rad <= settings.weak_rad
    if agreed.consent >= settings.weak_consent and is_narrow:
        return Placed(Outcome.WEAK, prior.fused(found.pose, settings.weak_factor * found.covariance), agreed)
    return Placed(Outcome.CONTRADICTS, prior, agreed)


def near_prior(
    ground: Ground, readings: Readings, prior: Believed, settings: PlacingSettings
) -> tuple[Tracked, Agreement] | None:
    """Return where a sweep was taken, about where that is believed, and how well walls hold it there.

    Along a wall all places are as good; the agreement is that of the best of them. None with too few readings.
    """
    best = _best_near(ground, readings, prior, settings)
    if best is None:
        return None
    found, agreed = best
    about = Pose2(prior.pose.x_m, prior.pose.y_m, found.pose.heading_rad)
    box = PoseBox.around(about, _half_m(prior, settings.box_sigmas, settings), settings.ridge_rad)
    pose, scatter = ridge_of(ground.walls, ground.ternary.vacant, readings, box, settings.refinement)
    return replace(found, pose=pose, covariance=found.covariance + scatter), agreed


def _best_near(
    ground: Ground, readings: Readings, prior: Believed, settings: PlacingSettings
) -> tuple[Tracked, Agreement] | None:
    far = _within(ground, readings, prior, settings.box_sigmas, settings)
    if far is None or far[1].explained_share >= settings.sure_share:
        return far
    # Asked as well: over a wide box some pose nearly always explains a little more, and that little is no
    # reason to jump.
    near = _within(ground, readings, prior, settings.near_sigmas, settings)
    if near is None:
        return far
    gained = _worth(far[1], settings) - _worth(near[1], settings)
    less_believed = prior.disbelief(far[0].pose) - prior.disbelief(near[0].pose)
    return far if gained >= settings.far_gain * less_believed else near


def _half_m(prior: Believed, sigmas: float, settings: PlacingSettings) -> float:
    return sigmas * prior.deviation_m + settings.box_m


def _within(
    ground: Ground, readings: Readings, prior: Believed, sigmas: float, settings: PlacingSettings
) -> tuple[Tracked, Agreement] | None:
    box = PoseBox.around(prior.pose, _half_m(prior, sigmas, settings), sigmas * prior.deviation_rad)
    return _in_box(ground, readings, box, settings)


def _in_box(
    ground: Ground, readings: Readings, box: PoseBox, settings: PlacingSettings
) -> tuple[Tracked, Agreement] | None:
    if len(readings) < settings.readings_min:
        return None
    found = track(ground.walls, readings, box, settings.tracking, settings.refinement)
    best = found.best if isinstance(found, NotHere) else found
    return None if best is None else (best, ground.agreement(readings, best.pose))


def found_within(
    ground: Ground, readings: Readings, area: Area, headings_rad: tuple[float, float], least_share: float
) -> Believed | None:
    """Return the one place in a disk where a sweep was taken; None if it is not there, or in doubt where.

    Args:
        ground: the map.
        readings: the sweep.
        area: where to look.
        headings_rad: the middle of the headings to try, and how far to either side.
        least_share: what the best pose must explain to be looked at.
    """
    settings = replace(
        ground.localization, localized_share=least_share, heading_error_rad=min(headings_rad[1], math.pi)
    )
    ready = replace(ground.ready, settings=settings)
    localizer = Localizer.at_stop(ready, "", settings.headings_near(headings_rad[0]), area)
    localizer.stop.add(readings)
    estimate = localizer.estimate(0, final=True)
    if estimate.state is not PoseState.LOCALIZED or estimate.best is None:
        return None
    return Believed(estimate.best, np.array(estimate.regions[0].covariance))


def _wide(
    ground: Ground, readings: Readings, prior: Believed, settings: PlacingSettings
) -> tuple[Tracked, Agreement] | None:
    radius_m = settings.wide_m + settings.wide_sigmas * prior.deviation_m
    half_rad = settings.wide_rad + settings.wide_sigmas * prior.deviation_rad
    area = Area(prior.pose.x_m, prior.pose.y_m, radius_m)
    found = found_within(ground, readings, area, (prior.pose.heading_rad, half_rad), settings.wide_share)
    return None if found is None else near_prior(ground, readings, found, settings)


def is_explained(agreed: Agreement, settings: PlacingSettings) -> bool:
    """Return whether a map explains a sweep: most of what it speaks of, and enough of all."""
    return agreed.consent >= settings.placed_consent and agreed.explained_share >= settings.placed_share


def _worth(agreed: Agreement, settings: PlacingSettings) -> float:
    return agreed.consent * min(1.0, agreed.explained_share / settings.wide_share)


def _widened(prior: Believed, settings: PlacingSettings) -> Believed:
    return Believed(prior.pose, settings.new_ground_factor * prior.covariance)
