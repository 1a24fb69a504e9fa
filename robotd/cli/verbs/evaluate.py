"""``eval``: read logs, seek their scans, report."""

import argparse
import subprocess
from collections.abc import Callable
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from robotd import __version__, config
from robotd.cli.eval_lines import Say, answered_before, is_standard_output, result_lines
from robotd.cli.exit_codes import INTERRUPTED, OK
from robotd.cli.logs import LOG_HELP, RAW_HELP, Reading, reading_arguments, refuse_raw_odometry
from robotd.cli.outputs import EVAL_LINES, PICTURES, STANDARD_OUTPUT, output_argument
from robotd.cli.pictures.plots_extra import require_plots
from robotd.cli.quantities import positive, whole, within
from robotd.cli.show.evaluation_tables import print_parameters, print_report, print_summary
from robotd.cli.show.terminal import err
from robotd.cli.surveys import evaluate_surveys
from robotd.cli.verb import Verb
from robotd.core.errors import RecordingError
from robotd.evaluation.answered import Answered
from robotd.evaluation.division import Division
from robotd.evaluation.log_report import LogReport, MapFacts
from robotd.evaluation.processes import over_processes
from robotd.evaluation.protocol import WORDS as PROTOCOL_WORDS
from robotd.evaluation.protocol import Protocol, checked_word
from robotd.evaluation.recorded import Reach
from robotd.evaluation.result import CaseResult
from robotd.evaluation.seeking import Seeking, SeekingSettings, run
from robotd.evaluation.tally import Tally
from robotd.evaluation.verdict import RIGHT_M, RIGHT_RAD
from robotd.grid import kernels
from robotd.grid.settings import GridSettings
from robotd.head.cores import cores
from robotd.logs.scan import RecordedLog, Scan

_Draw = Callable[[Path, Seeking, Scan, CaseResult], None]


@dataclass(frozen=True, slots=True)
class _Plan:
    """How all logs are treated."""

    cases: int
    seed: int
    grids: tuple[GridSettings, ...]
    """One for each size of cells."""
    protocols: tuple[Protocol, ...]
    job: SeekingSettings
    workers: int
    commit: str

    def document(self) -> dict[str, Any]:
        """Return everything that the figures depend on."""
        return {
            "robotd": __version__,
            "commit": self.commit,
            "kernels": str(kernels.in_use().about),
            "right_within": {"m": RIGHT_M, "rad": RIGHT_RAD},
            "cases": self.cases,
            "seed": self.seed,
            "protocols": [protocol.name for protocol in self.protocols],
            "grid": asdict(self.grids[0]) | {"resolution_m": [grid.resolution_m for grid in self.grids]},
            **asdict(self.job),
        }


@dataclass(frozen=True, slots=True, eq=False)
class _Task:
    """One line of the last table: a log, asked in one way on cells of one size."""

    name: str
    log: RecordedLog
    protocol: Protocol
    grid: GridSettings


def _eval(arguments: argparse.Namespace) -> int:
    if arguments.slam:
        with result_lines(arguments.json) as say:
            return evaluate_surveys(arguments, say, shows=not is_standard_output(arguments.json))
    plan = _plan(arguments)
    draw = _drawing() if arguments.pictures is not None else None
    logs = _logs(arguments)
    tasks = [
        _Task(name, log, protocol, grid) for name, log in logs for protocol in plan.protocols for grid in plan.grids
    ]
    # Read before the file is begun again; and then written first, so that a second end loses nothing of the first run.
    before = answered_before(arguments.json) if arguments.resume else Answered({})
    reports: list[LogReport] = []
    with result_lines(arguments.json) as say:
        say({"parameters": plan.document()})
        for result in before.results.values():
            say(result.document())
        with suppress(KeyboardInterrupt):
            for task in tasks:
                reports.append(_evaluate(plan, task, before, say, draw and _into(arguments.pictures, draw)))
                say(reports[-1].document())
                if reports[-1].is_cut:
                    break
    if not is_standard_output(arguments.json):
        _tell(plan, reports)
    return OK if len(reports) == len(tasks) and not reports[-1].is_cut else INTERRUPTED


def _plan(arguments: argparse.Namespace) -> _Plan:
    read = config.load(arguments.config) if arguments.config else config.Config()
    alphas = {"raise_alpha": arguments.raise_alpha, "lower_alpha": arguments.lower_alpha}
    grids = tuple(GridSettings(resolution_m=side_m, rows=1, cols=1, **alphas) for side_m in arguments.resolution)
    reach = Reach(arguments.range_max, min(arguments.clear, arguments.range_max))
    # Threads or processes, not both: they would take each other the same processors.
    threads = cores() if arguments.workers == 1 else 1
    job = SeekingSettings(reach, read.localization, read.judgement, read.error_model, threads)
    protocols = tuple(_protocol(arguments, word) for word in arguments.protocol or ["interleaved"])
    return _Plan(arguments.cases, arguments.seed, grids, protocols, job, arguments.workers, _commit())


def _protocol(arguments: argparse.Namespace, word: str) -> Protocol:
    if not word.startswith("other="):
        return Protocol(word)
    path = Path(word.removeprefix("other="))
    log = Reading.of(arguments).read(path)
    if not arguments.raw:
        refuse_raw_odometry(path, log)
    return Protocol(f"other={path.name}", log)


def _commit() -> str:
    """Return which commit this is, as far as a clone tells; else the version."""
    git = ["git", "-C", str(Path(__file__).parent), "describe", "--always", "--dirty", "--abbrev=12"]
    with suppress(OSError, subprocess.SubprocessError):
        return subprocess.run(git, capture_output=True, check=True, text=True, timeout=5.0).stdout.strip()
    return __version__


def _logs(arguments: argparse.Namespace) -> list[tuple[str, RecordedLog]]:
    """Read all logs before the first is sought: a log that will not do is told at once."""
    reading = Reading.of(arguments)
    logs = [(path, reading.read(path)) for path in arguments.log]
    if not arguments.raw:
        for path, log in logs:
            refuse_raw_odometry(path, log)
    return [(path.name, log) for path, log in logs]


def _drawing() -> _Draw:
    require_plots("--pictures")
    from robotd.cli.pictures.failures import draw_failure  # noqa: PLC0415  # only here is the extra needed

    return draw_failure


def _into(directory: Path, draw: _Draw) -> Callable[[Seeking, Scan, CaseResult], None]:
    return lambda job, scan, result: draw(directory, job, scan, result)


def _evaluate(
    plan: _Plan,
    task: _Task,
    before: Answered,
    say: Say,
    draw: Callable[[Seeking, Scan, CaseResult], None] | None,
) -> LogReport:
    """Make the map of a log and seek its queries but those that were answered before; Ctrl-C keeps what was done."""
    job, division = _job(plan, task)
    scans = {query.number: query.scan for query in division.queries}
    known = before.part(map(job.key_of, division.queries))
    left = [query for query in division.queries if job.key_of(query) not in known]
    tally = Tally()
    for result in known.values():
        tally.add(result)
    with _bar() as bar, suppress(KeyboardInterrupt):
        shown = bar.add_task(task.name, total=len(division.queries), completed=len(known))
        for result in run(job, left, map if plan.workers == 1 else over_processes(plan.workers)):
            tally.add(result)
            say(result.document())
            if draw is not None:
                draw(job, scans[result.key.scan], result)
            bar.update(shown, advance=1)
    counts = len(task.log.scans), len(division.map_scans), len(division.queries)
    facts = MapFacts.of(job.grid)
    return LogReport(task.name, task.protocol.name, *counts, facts, tally, task.log.poses, task.log.damaged_lines)


def _job(plan: _Plan, task: _Task) -> tuple[Seeking, Division]:
    try:
        grid, division = task.protocol.map_and_queries(
            task.log, plan.job.reach, task.grid, cases=plan.cases, seed=plan.seed
        )
    except ValueError as error:
        raise RecordingError(f"{task.name}: no map can be made of it: {error}") from error
    job = Seeking.of(task.name, grid, plan.job, seed=plan.seed, commit=plan.commit, protocol=task.protocol.name)
    return job, division


def _bar() -> Progress:
    columns = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    return Progress(*columns, console=err(), disable=not err().is_terminal)


def _tell(plan: _Plan, reports: list[LogReport]) -> None:
    for report in reports:
        print_report(report)
    if len(reports) > 1:
        print_summary(reports)
    print_parameters(plan.document())


def _protocol_word(text: str) -> str:
    try:
        return checked_word(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def _map_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--resolution",
        type=within(GridSettings, "resolution_m"),
        nargs="+",
        default=[0.05],
        metavar="M",
        help="sides of cells of the map [m], each a map of its own (default: 0.05)",
    )
    parser.add_argument(
        "--raise-alpha",
        type=within(GridSettings, "raise_alpha"),
        default=0.5,
        metavar="A",
        help="share of the doubt that a hit leaves (default: 0.5)",
    )
    parser.add_argument(
        "--lower-alpha",
        type=within(GridSettings, "lower_alpha"),
        default=0.9,
        metavar="A",
        help="share of an obstacle that a beam through it leaves (default: 0.9)",
    )
    reading_arguments(parser, range_max_m=30.0)
    parser.add_argument(
        "--clear",
        type=positive,
        default=8.0,
        metavar="M",
        help="how far a beam that met nothing is believed to be free [m] (default: 8)",
    )
    parser.add_argument(
        "--config",
        type=Path,
        metavar="FILE",
        help="take the settings of localization from a configuration of robotd",
    )


def _arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("log", type=Path, nargs="+", metavar="LOG", help=f"{LOG_HELP}; its poses are the truth")
    parser.add_argument("--raw", action="store_true", help=RAW_HELP)
    parser.add_argument(
        "--slam",
        action="store_true",
        help="map each log from its raw odometry, as the daemon maps, and tell how far it is from the relations in the "
        "file beside it (intel.relations beside intel.raw.clf); nothing is sought then",
    )
    parser.add_argument("--cases", type=whole(1), default=100, metavar="N", help="scans to seek (default: 100)")
    parser.add_argument("--seed", type=whole(0), default=0, metavar="N", help="chooses them (default: 0)")
    parser.add_argument(
        "--protocol",
        type=_protocol_word,
        action="append",
        metavar="P",
        help=f"how to ask, once for each: {', '.join(PROTOCOL_WORDS)} (default: interleaved)",
    )
    parser.add_argument(
        "--workers", type=whole(1), default=1, metavar="N", help="processes that share the cases (default: 1)"
    )
    _map_arguments(parser)
    output_argument(parser, "--pictures", PICTURES, "draw each case that is not right into a file there")
    parser.add_argument(
        "--resume",
        action="store_true",
        help="go on where the run was ended that wrote the file of --json: what it answered, by the same program and "
        "settings, is not asked again",
    )
    words = "write results to a file as they come, a JSON line each; without a file print them instead of the tables"
    output_argument(parser, "--json", EVAL_LINES, words, nargs="?", const=STANDARD_OUTPUT)


VERBS = (
    Verb(
        "eval",
        "tell how often localization is right, ambiguous, lost, or sure and wrong on real logs",
        "robotctl eval intel.corrected.log.gz --cases 100 --pictures failures",
        _eval,
        _arguments,
        prints_json=False,
    ),
)
