"""Ways on the map: where a mission drives, what becomes of its stops, and why there is no way to a place."""

import enum
from dataclasses import dataclass

import msgspec

Point = tuple[float, float]
"""``(x_m, y_m)`` in the map frame."""


class Hindrance(enum.StrEnum):
    """Why there is no way."""

    OUTSIDE = "outside"
    """The goal lies outside the map."""
    OBSTACLE = "obstacle"
    """The goal lies in an obstacle."""
    UNKNOWN = "unknown"
    """The goal has not been seen."""
    TOO_NEAR = "too_near"
    """The goal is too near to an obstacle or to unknown ground for the robot to fit."""
    START_OUTSIDE = "start_outside"
    """The robot stands outside the map."""
    NO_WAY = "no_way"
    """No way leads to the goal."""
    NOT_LOCALIZED = "not_localized"
    """It is not known where the robot is."""


class Way(msgspec.Struct, frozen=True):
    """A way, or why there is none."""

    waypoints_m: tuple[Point, ...]
    """Corners after the start; the last is the goal itself. Empty if there is no way."""
    length_m: float
    """Of all legs; 0 if there is no way."""
    reason: Hindrance | None = None
    """Why there is none; None if there is one."""
    message: str = ""
    """The same for people; empty if there is a way."""
    nearest_m: Point | None = None
    """The reachable point nearest to the goal; None if the robot cannot move at all, or there is a way."""


class StopState(enum.StrEnum):
    """What becomes of a stop."""

    WAITING = "waiting"
    UNDER_WAY = "under_way"
    SWEPT = "swept"
    UNREACHED = "unreached"


@dataclass(frozen=True, slots=True)
class PlannedStop:
    """A place at which a mission shall sweep."""

    x_m: float
    y_m: float
    state: StopState = StopState.WAITING
    reason: Hindrance | None = None
    """Why it was not reached; None if it was, or may be."""
    nearest_m: Point | None = None
    """The reachable point nearest to it, if it was not reached and there is one."""


@dataclass(frozen=True, slots=True)
class MissionPlan:
    """What a mission intends: told whole, whenever it changes."""

    time_ns: int
    mission_id: int
    map_id: str
    start_m: Point | None
    """Where the way began that it drives; None as long as it drives none."""
    goal_m: Point | None
    """Where that leads."""
    waypoints_m: tuple[Point, ...]
    """Corners of that way after the start; the last is the goal."""
    stops: tuple[PlannedStop, ...]
    """Where it sweeps, in order; empty if it only drives."""
