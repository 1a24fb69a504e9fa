"""Missions of a demonstration: what they say while they run, and what is kept of them."""

import math
import sys
from dataclasses import dataclass
from statistics import median
from typing import NamedTuple, Self

from rich.console import Console
from rich.table import Table

from robotd.cli.show.progress import MissionBars
from robotd.cli.show.terminal import plain_console
from robotd.cli.show.wording import held_in_words
from robotd.client import Client
from robotd.client.mission_run import MissionEvent, final_estimate
from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.contract.events import MissionPhase, MissionProgress, Status, SweepDone
from robotd.contract.explored import ExploringEnded
from robotd.contract.missions import Explore, Mission
from robotd.core.angles import wrap_rad
from robotd.core.errors import MissionError
from robotd.core.pose import Pose2
from robotd.core.reading import ReadingStatus, Sweep

LEASE_S = 10.0
"""Generous: a demonstration shares two cores with its simulated hardware, and with whatever else runs."""
_WIDTH = 120


def stage() -> Console:
    """Return where a demonstration tells its story; wide enough for its tables where there is no terminal."""
    return plain_console(sys.stdout, None if sys.stdout.isatty() else _WIDTH)


class Followed(NamedTuple):
    """What a mission came to."""

    sweeps: tuple[Sweep, ...]
    estimate: PoseEstimate | None
    """What a localization found."""
    explored: ExploringEnded | None
    """Why exploring ended, and what it left open."""


def follow(console: Console, client: Client, mission: Mission) -> Followed:
    """Run a mission to its end and return what it came to."""
    events: list[MissionEvent] = []
    with MissionBars() if console.is_terminal else _Narrator(console) as teller:
        for event in client.run_mission(mission, LEASE_S):
            teller.show(event)
            events.append(event)
    sweeps = tuple(event.sweep for event in events if isinstance(event, SweepDone))
    explored = next((event for event in events if isinstance(event, ExploringEnded)), None)
    try:
        return Followed(sweeps, final_estimate(events), explored)
    except MissionError:
        return Followed(sweeps, None, explored)


class _Narrator:
    """Progress for a log file: a line a stop."""

    def __init__(self, console: Console) -> None:
        self._console = console

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        """Leave nothing behind."""

    def show(self, event: MissionEvent) -> None:
        """Tell what is worth a line."""
        if isinstance(event, MissionProgress) and event.phase is MissionPhase.SWEEPING and event.stops > 1:
            # Who explores does not know how many it will be.
            of = "" if event.kind == Explore.kind else f" of {event.stops}"
            self._console.print(f"  stop {event.stop + 1}{of}: sweeping")
        elif isinstance(event, MissionProgress) and event.message:
            self._console.print(f"  {event.message}")
        elif isinstance(event, Status):
            self._console.print(f"  {held_in_words(event)}")


@dataclass(frozen=True, slots=True)
class Trial:
    """One localization, and the truth about it."""

    sweep: Sweep
    truth: Pose2
    estimate: PoseEstimate

    @property
    def error_m(self) -> float | None:
        """How far the estimate is from the truth; None if there is no unique estimate."""
        best = self.estimate.best
        return None if best is None else best.distance_m(self.truth)


def print_readings(console: Console, sweeps: tuple[Sweep, ...]) -> None:
    """Say what the sweeps brought."""
    taken = sum(len(sweep.readings) for sweep in sweeps)
    hits, misses = (sum(sweep.count(status) for sweep in sweeps) for status in (ReadingStatus.OK, ReadingStatus.MISS))
    console.print(
        f"  {len(sweeps)} stops, {taken} readings taken: {hits} hits, {misses} misses, {taken - hits - misses} rejected"
    )


def print_trials(console: Console, trials: list[Trial]) -> None:
    """Print truth, estimate and error of each localization, and the median error."""
    # Eighty columns are what many terminals have.
    headers = ("", "truth [m]", "estimate [m]", "error\n[mm]", "error\n[deg]", "rank /\nreadings", "regions", "state")
    table = Table(*headers, box=None, pad_edge=False, header_style="bold")
    for number, trial in enumerate(trials, 1):
        best, error_m = trial.estimate.best, trial.error_m
        heading = "-" if best is None else f"{math.degrees(wrap_rad(best.heading_rad - trial.truth.heading_rad)):+.2f}"
        table.add_row(
            str(number),
            f"{trial.truth.x_m:.3f}, {trial.truth.y_m:.3f}",
            "-" if best is None else f"{best.x_m:.3f}, {best.y_m:.3f}",
            "-" if error_m is None else f"{1000 * error_m:.0f}",
            heading,
            f"{trial.estimate.best_rank or 'too few'} / {trial.estimate.readings}",
            str(len(trial.estimate.regions)),
            trial.estimate.state.value,
        )
    console.print(table)
    errors = [trial.error_m for trial in trials if trial.error_m is not None]
    sure = sum(trial.estimate.state is PoseState.LOCALIZED for trial in trials)
    middle = f"median error {1000 * median(errors):.0f} mm" if errors else "no error to speak of"
    console.print(f"  {sure} of {len(trials)} localized; {middle}")
