"""What a calibration asks for, is told, and finds."""

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.contract.missions import Mission
from robotd.core.errors import CalibrationError
from robotd.core.reading import Sweep


@dataclass(frozen=True, slots=True)
class Constants:
    """What the daemon is configured with: what it says is said with these."""

    counts_per_m: float
    counts_per_rad: float
    pan_zero_rad: float
    backlash_rad: float
    range_bias_m: float


@dataclass(frozen=True, slots=True)
class Step:
    """One thing to do next."""

    mission: Mission
    words: str
    """What for, for people."""


@dataclass(frozen=True, slots=True)
class Seen:
    """What there was to see after it, at rest."""

    counts: tuple[int, int] | None
    """What the encoders counted of translation and rotation so far; None if the base does not tell."""
    sweep: Sweep | None
    """What it swept, if it did."""


@dataclass(frozen=True, slots=True)
class Found:
    """One constant of the robot as it was found: which key of the configuration, how much, and how sure."""

    section: str
    """Of the configuration: ``drive``."""
    key: str
    unit: str
    value: float
    error: float
    """Standard deviation of the value."""
    before: float


@dataclass(frozen=True, slots=True, eq=False)
class Residuals:
    """What the constants leave unexplained, for a picture."""

    name: str
    unit: str
    values: NDArray[np.float64]
    """``float64[n]``."""


@dataclass(frozen=True, slots=True)
class Calibration:
    """The constants that one procedure found, and what people should know of how it went."""

    found: tuple[Found, ...]
    residuals: tuple[Residuals, ...]


Procedure = Generator[Step, Seen, Calibration]
"""A calibration, without a robot: it yields what to do next, and is sent what was seen then."""


def swept(seen: Seen) -> Sweep:
    """Return the sweep that was asked for; CalibrationError if there is none."""
    if seen.sweep is None:
        raise CalibrationError("the sweep that was asked for did not come")
    return seen.sweep


def counted(seen: Seen) -> tuple[int, int]:
    """Return the counts; CalibrationError if the base does not tell them."""
    if seen.counts is None:
        raise CalibrationError("the base tells no counts: is it plugged in?")
    return seen.counts
