"""A calibration carried out by a client: step by step, told as it goes, and the robot stopped if anything ends it."""

from collections.abc import Callable

from robotd.calibration.found import Calibration, Constants, Procedure, Seen, Step
from robotd.cli.motion import shown
from robotd.client import Client
from robotd.client.mission_run import MissionEvent
from robotd.config import Config
from robotd.contract.events import MissionProgress, SweepDone, SweepProgress
from robotd.contract.topics import Topic
from robotd.core.errors import RequestTimeout
from robotd.core.pose import Odometry

_PATIENCE_S = 3.0


def constants_of(config: Config) -> Constants:
    """Return what a daemon with this configuration believes of its robot."""
    drive, head, laser = config.drive, config.pantilt, config.rangefinder
    return Constants(drive.counts_per_m, drive.counts_per_rad, head.pan_zero_rad, head.backlash_rad, laser.range_bias_m)


def guided(client: Client, procedure: Procedure, tell: Callable[[str], None]) -> Calibration:
    """Carry a calibration out and return what it found.

    Raises:
        MissionError: a step was stopped, or failed.
        CalibrationError: what was seen tells nothing.
    """
    step, number = next(procedure), 1
    while True:
        tell(f"{number}: {step.words}")
        try:
            step, number = procedure.send(_seen(client, step)), number + 1
        except StopIteration as end:
            found: Calibration = end.value
            return found


def _seen(client: Client, step: Step) -> Seen:
    with shown(client, step.mission) as events:
        kept: list[MissionEvent] = [event for event in events if not isinstance(event, SweepProgress)]
    sweeps = [event.sweep for event in kept if isinstance(event, SweepDone)]
    ended_ns = next(event.time_ns for event in reversed(kept) if isinstance(event, MissionProgress))
    return Seen(_counts(client, ended_ns), sweeps[-1] if sweeps else None)


def _counts(client: Client, since_ns: int) -> tuple[int, int] | None:
    """Return what the encoders say at rest: by odometry measured after the mission's end."""
    with client.subscribe(Topic.ODOMETRY) as events:
        while (event := events.next(_PATIENCE_S)) is not None:
            if isinstance(event, Odometry) and event.time_ns >= since_ns:
                return event.counts
    raise RequestTimeout("no odometry: is the base plugged in? See: robotctl status")
