"""``eval``: read logs, seek their scans, report."""

import argparse
import json
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from robotd import __version__, config
from robotd.cli.logs import LOG_HELP, RAW_HELP, Reading, reading_arguments, refuse_raw_odometry
from robotd.cli.outputs import EVAL_LINES, PICTURES, STANDARD_OUTPUT, output_argument, writing
from robotd.cli.pictures.plots_extra import require_plots
from robotd.cli.quantities import positive, whole, within
from robotd.cli.show.evaluation_tables import print_parameters, print_report, print_summary
from robotd.cli.show.terminal import err
from robotd.cli.verb import INTERRUPTED, OK, Verb
from robotd.core.errors import RecordingError
from robotd.evaluation.division import Division, divide
from robotd.evaluation.job import Job, JobSettings, run
from robotd.evaluation.log_report import LogReport, MapFacts
from robotd.evaluation.recorded import Reach, map_of
from robotd.evaluation.result import Result
from robotd.evaluation.tally import Tally
from robotd.evaluation.verdict import RIGHT_M, RIGHT_RAD
from robotd.grid import kernels
from robotd.grid.occupancy import GridSettings
from robotd.logs.scan import RecordedLog, Scan
from robotd.mission.compute import cores

_Draw = Callable[[Path, Job, Scan, Result], None]
_Say = Callable[[dict[str, Any]], None]


@dataclass(frozen=True, slots=True)
class _Plan:
    """How all logs are treated."""

    cases: int
    seed: int
    grid: GridSettings
    job: JobSettings
    commit: str

    def document(self) -> dict[str, Any]:
        """Return everything that the figures depend on."""
        return {
            "robotd": __version__,
            "commit": self.commit,
            "kernels": str(kernels.IN_USE),
            "right_within": {"m": RIGHT_M, "rad": RIGHT_RAD},
            "cases": self.cases,
            "seed": self.seed,
            "grid": asdict(self.grid),
            **asdict(self.job),
        }


def _eval(arguments: argparse.Namespace) -> int:
    plan = _plan(arguments)
    draw = _drawing() if arguments.pictures is not None else None
    logs = _logs(arguments)
    reports: list[LogReport] = []
    with _lines(arguments.json) as say:
        say({"parameters": plan.document()})
        with suppress(KeyboardInterrupt):
            for name, log in logs:
                reports.append(_evaluate(plan, name, log, say, draw and _into(arguments.pictures, draw)))
                say(reports[-1].document())
                if reports[-1].is_cut:
                    break
    if not _is_standard_output(arguments.json):
        _tell(plan, reports)
    return OK if len(reports) == len(logs) and not reports[-1].is_cut else INTERRUPTED


def _plan(arguments: argparse.Namespace) -> _Plan:
    read = config.load(arguments.config) if arguments.config else config.Config()
    grid = GridSettings(
        resolution_m=arguments.resolution,
        rows=1,
        cols=1,
        raise_alpha=arguments.raise_alpha,
        lower_alpha=arguments.lower_alpha,
    )
    reach = Reach(arguments.range_max, min(arguments.clear, arguments.range_max))
    job = JobSettings(reach, read.localization, read.judgement, read.error_model, cores())
    return _Plan(arguments.cases, arguments.seed, grid, job, _commit())


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


def _into(directory: Path, draw: _Draw) -> Callable[[Job, Scan, Result], None]:
    return lambda job, scan, result: draw(directory, job, scan, result)


@contextmanager
def _lines(file: Path | None) -> Iterator[_Say]:
    """Say documents as JSON lines, each as soon as it is known, to a file, to standard output, or to nobody."""
    if file is None:
        yield lambda _: None
    elif _is_standard_output(file):
        yield lambda document: print(_line(document), flush=True)
    else:
        with writing(file) as write:
            yield lambda document: write(f"{_line(document)}\n".encode())


def _line(document: dict[str, Any]) -> str:
    return json.dumps(document, allow_nan=False)


def _is_standard_output(file: Path | None) -> bool:
    return str(file) == STANDARD_OUTPUT


def _evaluate(
    plan: _Plan, name: str, log: RecordedLog, say: _Say, draw: Callable[[Job, Scan, Result], None] | None
) -> LogReport:
    """Make the map of a log and seek its queries; Ctrl-C keeps what was done."""
    division = divide(log, plan.cases, plan.seed)
    job = _job(plan, name, division)
    scans = {query.number: query.scan for query in division.queries}
    tally = Tally()
    with _bar() as bar, suppress(KeyboardInterrupt):
        task = bar.add_task(name, total=len(division.queries))
        for result in run(job, division.queries):
            tally.add(result)
            say(result.document())
            if draw is not None:
                draw(job, scans[result.key.scan], result)
            bar.update(task, advance=1)
    counts = len(log.scans), len(division.map_scans), len(division.queries)
    return LogReport(name, *counts, MapFacts.of(job.grid), tally, log.poses, log.damaged_lines)


def _job(plan: _Plan, name: str, division: Division) -> Job:
    try:
        grid = map_of(division.map_scans, plan.job.reach, plan.grid)
    except ValueError as error:
        raise RecordingError(f"{name}: no map can be made of it: {error}") from error
    return Job.of(name, grid, plan.job, seed=plan.seed, commit=plan.commit)


def _bar() -> Progress:
    columns = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    return Progress(*columns, console=err(), disable=not err().is_terminal)


def _tell(plan: _Plan, reports: list[LogReport]) -> None:
    for report in reports:
        print_report(report)
    if len(reports) > 1:
        print_summary(reports)
    print_parameters(plan.document())


def _arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("log", type=Path, nargs="+", metavar="LOG", help=f"{LOG_HELP}; its poses are the truth")
    parser.add_argument("--raw", action="store_true", help=RAW_HELP)
    parser.add_argument("--cases", type=whole(1), default=100, metavar="N", help="scans to seek (default: 100)")
    parser.add_argument("--seed", type=whole(0), default=0, metavar="N", help="chooses them (default: 0)")
    parser.add_argument(
        "--resolution",
        type=within(GridSettings, "resolution_m"),
        default=0.05,
        metavar="M",
        help="side of a cell of the map [m] (default: 0.05)",
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
    output_argument(parser, "--pictures", PICTURES, "draw each case that is not right into a file there")
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
