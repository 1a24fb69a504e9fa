"""``eval``: scans of logs sought on the maps that the rest of them makes, spread by whatever schedule was named."""

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from robotd import __version__, config
from robotd.cli.eval_lines import Say, answered_before, is_standard_output, result_lines
from robotd.cli.exit_codes import INTERRUPTED, OK
from robotd.cli.logs import Reading, refuse_raw_odometry
from robotd.cli.pictures.plots_extra import require_plots
from robotd.cli.show.evaluation_tables import print_parameters, print_report, print_summary
from robotd.cli.show.terminal import err
from robotd.evaluation.answered import Answered
from robotd.evaluation.asked_log import AskedLog
from robotd.evaluation.cluster import over_cluster, require_dask
from robotd.evaluation.log_report import LogReport
from robotd.evaluation.portions import PORTION, PortionAnswer, ask
from robotd.evaluation.processes import over_processes
from robotd.evaluation.protocol import Protocol
from robotd.evaluation.recorded import Reach
from robotd.evaluation.result import CaseResult
from robotd.evaluation.schedule import Schedule, in_this_process
from robotd.evaluation.seeking import Seeking, SeekingSettings
from robotd.evaluation.tally import Tally
from robotd.evaluation.verdict import RIGHT_M, RIGHT_RAD
from robotd.evaluation.which_program import program
from robotd.grid import kernels
from robotd.grid.settings import GridSettings
from robotd.head.cores import cores
from robotd.logs.scan import RecordedLog, Scan
from robotd.sim.buildings.log_file import STANDARD_INPUT

_Draw = Callable[[Seeking, Scan, CaseResult], None]
_KEPT_SCANS = 60_000
"""Scans that are kept when all logs are looked at, some 200 MB; other logs are read again when it is their turn."""


@dataclass(frozen=True, slots=True)
class _Plan:
    """How all logs are treated."""

    cases: int
    seed: int
    grids: tuple[GridSettings, ...]
    """One for each size of cells."""
    protocols: tuple[Protocol, ...]
    job: SeekingSettings

    def document(self) -> dict[str, Any]:
        """Return everything that the figures depend on."""
        return {
            "robotd": __version__,
            "commit": program(),
            "kernels": str(kernels.in_use().about),
            "right_within": {"m": RIGHT_M, "rad": RIGHT_RAD},
            "cases": self.cases,
            "seed": self.seed,
            "protocols": [protocol.name for protocol in self.protocols],
            "grid": asdict(self.grids[0]) | {"resolution_m": [grid.resolution_m for grid in self.grids]},
            **asdict(self.job),
        }

    def questions(self, name: str, log: RecordedLog) -> Iterator[AskedLog]:
        """Yield what is asked of a log: in each way, on cells of each size."""
        for protocol in self.protocols:
            for grid in self.grids:
                yield AskedLog.of(name, log, protocol, grid, self.job, cases=self.cases, seed=self.seed)

    def asked(self, log: RecordedLog) -> int:
        """Return how many cases that is."""
        return len(self.grids) * sum(protocol.asked(len(log.scans), self.cases) for protocol in self.protocols)


@dataclass(frozen=True, slots=True)
class _Logs:
    """Logs by their paths: all looked at before the first is asked; as many are kept as memory bears."""

    reading: Reading
    paths: tuple[Path, ...]
    kept: dict[Path, RecordedLog]
    cases: int
    """How many there are in all of them."""

    @classmethod
    def looked_at(cls, arguments: argparse.Namespace, plan: _Plan) -> "_Logs":
        """Read all, and say on standard error what must be said of each.

        Raises:
            RecordingError: one will not do.
        """
        reading, paths = Reading.of(arguments), tuple(arguments.log)
        kept: dict[Path, RecordedLog] = {}
        cases = scans = 0
        for path in paths:
            log = kept[path] if path in kept else reading.read(path)
            if not arguments.raw:
                refuse_raw_odometry(path, log)
            cases, scans = cases + plan.asked(log), scans + len(log.scans)
            # Standard input is there to be read once.
            if scans <= _KEPT_SCANS or str(path) == STANDARD_INPUT:
                kept[path] = log
        return cls(reading, paths, kept, cases)

    def named(self) -> Iterator[tuple[str, RecordedLog]]:
        """Yield them with their names."""
        for path in self.paths:
            yield path.name, self.kept[path] if path in self.kept else self.reading.reread(path)


def evaluate(arguments: argparse.Namespace) -> int:
    """Carry out ``eval``: look at all logs, then ask one after the other; Ctrl-C keeps what was done."""
    plan, draw = _plan(arguments), _drawing(arguments.pictures)
    schedule, most = _schedule(arguments)
    logs = _Logs.looked_at(arguments, plan)
    # Read before the file is begun again.
    before = answered_before(arguments.json) if arguments.resume else Answered()
    questions = (question for name, log in logs.named() for question in plan.questions(name, log))
    with result_lines(arguments.json) as say, _bar(logs.cases) as shown:
        say({"parameters": plan.document()})
        telling = _Telling(say, draw, shown, before)
        is_whole = False
        with suppress(KeyboardInterrupt):
            for question, answer in ask(questions, before, schedule, most):
                telling.take(question, answer)
            is_whole = True
        telling.end()
    if not is_standard_output(arguments.json):
        _tell(plan, telling.reports)
    return OK if is_whole else INTERRUPTED


@dataclass(slots=True, eq=False)
class _Telling:
    """What is told as answers come: lines, pictures, how far it is, and in the end the reports."""

    say: Say
    draw: _Draw | None
    shown: Callable[[str, int], None]
    before: Answered
    reports: list[LogReport] = field(default_factory=list)
    question: AskedLog | None = None

    def take(self, question: AskedLog, answer: PortionAnswer) -> None:
        """Tell some answers of a question."""
        if question is not self.question:
            self.question = question
            self.reports.append(question.report(answer.facts, Tally()))
        report = self.reports[-1]
        scans = {query.number: query.scan for query in question.queries}
        for result in answer.results:
            report.tally.add(result)
            self.say(result.document())
            if self.draw is not None and result.key not in self.before.results:
                self.draw(question.job, scans[result.key.scan], result)
        self.shown(report.name, len(answer.results))
        if not report.is_cut:
            self.say(report.document())

    def end(self) -> None:
        """Tell what a question came to that was interrupted."""
        if self.reports and self.reports[-1].is_cut:
            self.say(self.reports[-1].document())


def _plan(arguments: argparse.Namespace) -> _Plan:
    read = config.load(arguments.config) if arguments.config else config.Config()
    alphas = {"raise_alpha": arguments.raise_alpha, "lower_alpha": arguments.lower_alpha}
    grids = tuple(GridSettings(resolution_m=side_m, rows=1, cols=1, **alphas) for side_m in arguments.resolution)
    reach = Reach(arguments.range_max, min(arguments.clear, arguments.range_max))
    # Threads or processes, not both: they would take each other the same processors.
    is_spread = arguments.workers > 1 or arguments.scheduler is not None
    threads = 1 if is_spread else cores()
    job = SeekingSettings(reach, read.localization, read.judgement, read.error_model, threads)
    protocols = tuple(_protocol(arguments, word) for word in arguments.protocol or ["interleaved"])
    return _Plan(arguments.cases, arguments.seed, grids, protocols, job)


def _schedule(arguments: argparse.Namespace) -> tuple[Schedule, int]:
    """Return what spreads the cases, and how many at a time; one at a time here, so that Ctrl-C costs no answer."""
    if arguments.scheduler is not None:
        require_dask()
        return over_cluster(arguments.scheduler), PORTION
    return (over_processes(arguments.workers), PORTION) if arguments.workers > 1 else (in_this_process, 1)


def _protocol(arguments: argparse.Namespace, word: str) -> Protocol:
    if not word.startswith("other="):
        return Protocol(word)
    path = Path(word.removeprefix("other="))
    log = Reading.of(arguments).read(path)
    if not arguments.raw:
        refuse_raw_odometry(path, log)
    return Protocol(f"other={path.name}", log)


def _drawing(directory: Path | None) -> _Draw | None:
    if directory is None:
        return None
    require_plots("--pictures")
    from robotd.cli.pictures.failures import draw_failure  # noqa: PLC0415  # only here is the extra needed

    return partial(draw_failure, directory)


@contextmanager
def _bar(cases: int) -> Iterator[Callable[[str, int], None]]:
    """Show how far it is and what time is left, all logs together."""
    columns = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=err(), disable=not err().is_terminal) as bar:
        shown = bar.add_task("", total=cases)
        yield lambda name, more: bar.update(shown, advance=more, description=name)


def _tell(plan: _Plan, reports: list[LogReport]) -> None:
    for report in reports:
        print_report(report)
    if len(reports) > 1:
        print_summary(reports)
    print_parameters(plan.document())
