"""``eval``: read logs, seek their scans, report."""

import argparse
import json
from collections.abc import Callable
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from robotd import __version__, config
from robotd.cli.logs import LOG_HELP, RAW_HELP, Reading, reading_arguments, refuse_raw_odometry
from robotd.cli.outputs import EVAL_REPORT, PICTURES, STANDARD_OUTPUT, output_argument, write
from robotd.cli.pictures.plots_extra import require_plots
from robotd.cli.quantities import positive, whole, within
from robotd.cli.show.evaluation_tables import print_parameters, print_report, print_summary
from robotd.cli.show.terminal import err, print_json
from robotd.cli.verb import INTERRUPTED, OK, Verb
from robotd.core.errors import RecordingError
from robotd.evaluation.division import divide
from robotd.evaluation.recorded import Reach, map_of
from robotd.evaluation.report import LogReport
from robotd.evaluation.running import Searcher
from robotd.evaluation.verdict import RIGHT_M, RIGHT_RAD, Case
from robotd.grid import kernels
from robotd.grid.occupancy import GridSettings
from robotd.localization.judge.error_model import ErrorModel
from robotd.localization.judge.judgement import Judgement
from robotd.localization.settings import LocalizationSettings
from robotd.logs.scan import RecordedLog
from robotd.mission.compute import cores


@dataclass(frozen=True, slots=True)
class _Plan:
    """How all logs are treated."""

    cases: int
    seed: int
    reach: Reach
    grid: GridSettings
    localization: LocalizationSettings
    judgement: Judgement
    error_model: ErrorModel
    threads: int

    def document(self) -> dict[str, Any]:
        """Return everything that the figures depend on."""
        return {
            "robotd": __version__,
            "kernels": str(kernels.IN_USE),
            "right_within": {"m": RIGHT_M, "rad": RIGHT_RAD},
            **asdict(self),
        }


def _eval(arguments: argparse.Namespace) -> int:
    plan = _plan(arguments)
    draw = _drawing() if arguments.pictures is not None else None
    logs = _logs(arguments)
    reports: list[LogReport] = []
    with suppress(KeyboardInterrupt):
        for name, log in logs:
            reports.append(_evaluate(plan, name, log))
            if reports[-1].is_cut:
                break
    _tell(arguments.json, plan, reports)
    if draw is not None:
        for report in reports:
            draw(arguments.pictures, report)
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
    return _Plan(
        arguments.cases, arguments.seed, reach, grid, read.localization, read.judgement, read.error_model, cores()
    )


def _logs(arguments: argparse.Namespace) -> list[tuple[str, RecordedLog]]:
    """Read all logs before the first is sought: a log that will not do is told at once."""
    reading = Reading.of(arguments)
    logs = [(path, reading.read(path)) for path in arguments.log]
    if not arguments.raw:
        for path, log in logs:
            refuse_raw_odometry(path, log)
    return [(path.name, log) for path, log in logs]


def _drawing() -> Callable[[Path, LogReport], None]:
    require_plots("--pictures")
    from robotd.cli.pictures.failures import draw_failures  # noqa: PLC0415  # only here is the extra needed

    return draw_failures


def _evaluate(plan: _Plan, name: str, log: RecordedLog) -> LogReport:
    """Make the map of a log and seek its queries; Ctrl-C keeps what was done."""
    division = divide(log, plan.cases, plan.seed)
    try:
        grid = map_of(division.map_scans, plan.reach, plan.grid)
    except ValueError as error:
        raise RecordingError(f"{name}: no map can be made of it: {error}") from error
    cases: list[Case] = []
    searcher = Searcher(grid, plan.localization, plan.judgement, plan.error_model, plan.reach, plan.threads)
    with _bar() as bar, suppress(KeyboardInterrupt):
        task = bar.add_task(name, total=len(division.queries))
        for case in searcher.cases(division.queries):
            cases.append(case)
            bar.update(task, advance=1)
    counts = len(log.scans), len(division.map_scans), len(division.queries)
    return LogReport(name, *counts, grid, tuple(cases), log.poses, log.damaged_lines)


def _bar() -> Progress:
    columns = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    return Progress(*columns, console=err(), disable=not err().is_terminal)


def _tell(file: Path | None, plan: _Plan, reports: list[LogReport]) -> None:
    document = {"parameters": plan.document(), "logs": [report.document() for report in reports]}
    if file is not None and str(file) == STANDARD_OUTPUT:
        print_json(document)
        return
    if file is not None:
        write(file, (json.dumps(document, indent=1, allow_nan=False) + "\n").encode())
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
    words = "write everything to a file as JSON; without a file print it instead of the tables"
    output_argument(parser, "--json", EVAL_REPORT, words, nargs="?", const=STANDARD_OUTPUT)


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
