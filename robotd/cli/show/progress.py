"""Bars that grow while a mission is under way, on standard error."""

from types import TracebackType
from typing import Self

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn

from robotd.cli.show.terminal import err
from robotd.cli.show.wording import counts_in_words, estimate_in_short, held_in_words, mission_in_words
from robotd.contract.estimate import PoseEstimate
from robotd.contract.events import MissionPhase, MissionProgress, Status, SweepProgress
from robotd.contract.topics import Published


class MissionBars:
    """A bar for the stops of the mission, one for the readings of the sweep, and the pose as it firms up."""

    def __init__(self) -> None:
        self._progress = Progress(
            TextColumn("{task.description}", markup=False),
            BarColumn(bar_width=14),
            MofNCompleteColumn(),
            TextColumn("{task.fields[note]}", markup=False),
            console=err(),
        )
        self._mission: TaskID | None = None
        self._sweep: TaskID | None = None
        self._pose = ""

    def __enter__(self) -> Self:
        self._progress.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._progress.stop()

    def show(self, event: Published) -> None:
        """Move what the event moves."""
        match event:
            case MissionProgress():
                self._step(event)
            case SweepProgress():
                self._reading(event)
            case Status():
                self._progress.console.print(held_in_words(event))
            case PoseEstimate():
                self._pose = estimate_in_short(event)
                if self._mission is not None:
                    self._progress.update(self._mission, note=self._pose)

    def _step(self, step: MissionProgress) -> None:
        if self._mission is None:
            self._mission = self._progress.add_task(step.kind, total=step.stops, note="")
        finished = step.stops if step.phase is MissionPhase.DONE else step.stop
        self._progress.update(self._mission, completed=finished, description=f"{step.kind}: {step.phase}".ljust(19))
        if step.message and step.phase is not MissionPhase.DONE:  # its last word is the verb's answer
            self._progress.console.print(mission_in_words(step))

    def _reading(self, sweep: SweepProgress) -> None:
        if self._sweep is None:
            self._sweep = self._progress.add_task("sweep", total=sweep.total, note="")
        self._progress.update(
            self._sweep,
            description=f"sweep {sweep.number}",
            total=sweep.total,
            completed=sweep.taken,
            note=counts_in_words(sweep),
        )
