"""``eval --slam``: map logs from their raw odometry, and hold the maps against relations checked by hand."""

import argparse
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median
from typing import Any

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from robotd.cli.exit_codes import OK
from robotd.cli.logs import Reading
from robotd.cli.show.survey_tables import print_survey
from robotd.cli.show.terminal import complain, err
from robotd.core.errors import RecordingError
from robotd.evaluation.recorded import Reach
from robotd.evaluation.relation_errors import RelationErrors
from robotd.evaluation.surveyed import SurveyedLog, interpolated, located, stops_of, surveyed
from robotd.logs.relations import Relations
from robotd.logs.scan import RecordedLog
from robotd.sim.buildings.log_file import read_relations
from robotd.slam.survey import Decision, SurveySettings


@dataclass(frozen=True, slots=True)
class SurveyReport:
    """What mapping a log came to."""

    name: str
    scans: int
    stops: int
    relations: int
    unknown_relations: int
    errors: dict[str, RelationErrors]
    """By how the poses were come by; that of ``located`` counts."""
    outcomes: dict[str, int]
    cpu_s: dict[str, float]

    def document(self) -> dict[str, Any]:
        """Return it for programs."""
        return {"slam": asdict(self)}


def evaluate_surveys(arguments: argparse.Namespace, say: Callable[[dict[str, Any]], None], *, shows: bool) -> int:
    """Carry out ``eval --slam``: map each log, and tell programs and, if it ``shows``, people what that came to."""
    reading = Reading.of(arguments)
    logs = [(path, reading.read(path)) for path in arguments.log]
    relations = [read_relations(relations_beside(path), log) for path, log in logs]
    reach = Reach(arguments.range_max, min(arguments.clear, arguments.range_max))
    say({"parameters": {"reach": asdict(reach), "survey": asdict(SurveySettings())}})
    for (path, log), known in zip(logs, relations, strict=True):
        if known.unknown:
            complain(f"{path}: {known.unknown} relations are of times at which it has no scan; left out")
        report = _surveyed(path.name, log, known, reach)
        say(report.document())
        if shows:
            print_survey(report.name, report.document()["slam"])
    return OK


def relations_beside(log: Path) -> Path:
    """Return the file of relations beside a log: of its name, less one ending after the other.

    Raises:
        RecordingError: there is none.
    """
    names = list(_shorter(log.name))
    for name in names:
        beside = log.with_name(f"{name}.relations")
        if beside.is_file():
            return beside
    raise RecordingError(f"{log}: no relations beside it to measure a map by; looked for {names[-1]}.relations")


def _shorter(name: str) -> Iterator[str]:
    yield name
    while "." in name[1:]:
        name = name.rpartition(".")[0]
        yield name


def _surveyed(name: str, log: RecordedLog, relations: Relations, reach: Reach) -> SurveyReport:
    known = relations.known
    errors = {"raw odometry": RelationErrors.of(known, [scan.odometry for scan in log.scans])}
    cpu_s: dict[str, float] = {}
    front, cpu_s["front end"] = _timed(name, log, reach, SurveySettings(loops=None))
    errors["front end alone"] = RelationErrors.of(known, interpolated(front))
    found, cpu_s["survey"] = _timed(name, log, reach, SurveySettings())
    cpu_s["a stop, median"] = median(found.cpu_s) if found.cpu_s else 0.0
    begin_s = time.process_time()
    scans = [scan for relation in known for scan in (relation.one, relation.other)]
    errors["located"] = RelationErrors.of(known, located(found, scans, reach))
    cpu_s["locating"] = time.process_time() - begin_s
    errors["interpolated"] = RelationErrors.of(known, interpolated(found))
    counts = len(log.scans), len(found.stops), len(known), relations.unknown
    return SurveyReport(name, *counts, errors, dict(found.outcomes), cpu_s)


def _timed(name: str, log: RecordedLog, reach: Reach, settings: SurveySettings) -> tuple[SurveyedLog, float]:
    begin_s = time.process_time()
    columns = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=err(), disable=not err().is_terminal) as bar:
        shown = bar.add_task(name, total=len(stops_of(log.scans)))

        def told(stop: int, _: Sequence[Decision]) -> None:
            bar.update(shown, completed=stop + 1)

        found = surveyed(log.scans, reach, settings, told)
    return found, time.process_time() - begin_s
