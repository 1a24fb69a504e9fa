"""The report of a log as a table for people, and all logs in one."""

import math
from collections.abc import Iterator
from typing import Any

from rich.table import Table
from rich.text import Text

from robotd.cli.show.terminal import out, print_pairs
from robotd.evaluation.report import PERCENTILES, LogReport, percentiles
from robotd.evaluation.verdict import Verdict

_WORDS = {
    Verdict.RIGHT: "right",
    Verdict.WRONG_AND_SURE: "wrong and sure",
    Verdict.AMBIGUOUS: "ambiguous",
    Verdict.LOST: "lost",
}


def print_report(report: LogReport) -> None:
    """Print what became of the cases of one log."""
    spec = report.grid.spec
    size = f"{spec.cols} x {spec.rows} cells of {spec.resolution_m * 1000:g} mm"
    done = f"{len(report.cases)} cases" if not report.is_cut else _so_far(report)
    title = f"{report.log}: {done}; map of {report.map_scans} of {report.scans} scans, {size}"
    out().print(Text(title, style="bold"))
    shares = Table.grid(padding=(0, 2))
    for words, share in _shares(report):
        shares.add_row(Text(f"  {words}"), Text(f"{100 * share:5.1f} %"))
    out().print(shares)
    out().print(_percentile_table(report))


def _so_far(report: LogReport) -> str:
    return f"interrupted after {len(report.cases)} of {report.asked} cases"


def _shares(report: LogReport) -> list[tuple[str, float]]:
    shares = [(words, report.share(verdict)) for verdict, words in _WORDS.items()]
    return [*shares[:3], ("  of these with the truth among the answers", report.ambiguous_with_truth), *shares[3:]]


def _percentile_table(report: LogReport) -> Table:
    heads = [f"{percent} %" if percent < 100 else "most" for percent in PERCENTILES]
    table = Table("", *heads, box=None, header_style="dim")
    for column in table.columns[1:]:
        column.justify = "right"
    lines = (
        ("position error of the right [mm]", [1000 * error for error in report.errors_m], ".0f"),
        ("heading error of the right [deg]", [math.degrees(error) for error in report.errors_rad], ".2f"),
        ("processor time of a case [ms]", [1000 * case.cpu_s for case in report.cases], ".0f"),
        ("time to the answer [ms]", [1000 * case.wall_s for case in report.cases], ".0f"),
    )
    for name, values, form in lines:
        found = percentiles(values)
        table.add_row(Text(name), *(format(value, form) for value in found.values()) if found else ["-"] * len(heads))
    return table


def print_summary(reports: list[LogReport]) -> None:
    """Print one line for each log, and one for all their cases together."""
    table = Table(*("log", "cases", *_WORDS.values(), "with truth", "error", "CPU"), box=None, header_style="bold")
    for column in table.columns[1:]:
        column.justify = "right"
    for report in reports:
        _add_summary(table, report.log, [report])
    _add_summary(table, "all", reports)
    out().print(table)


def _add_summary(table: Table, name: str, reports: list[LogReport]) -> None:
    cases = sum(len(report.cases) for report in reports)
    errors = percentiles([error for report in reports for error in report.errors_m])
    cpu = percentiles([case.cpu_s for report in reports for case in report.cases])

    def share(shares: list[float]) -> str:
        counts = (part * len(report.cases) for part, report in zip(shares, reports, strict=True))
        return f"{100 * sum(counts) / cases:.1f} %" if cases else "-"

    table.add_row(
        Text(name),
        str(cases),
        *(share([report.share(verdict) for report in reports]) for verdict in _WORDS),
        share([report.ambiguous_with_truth for report in reports]),
        f"{1000 * errors['p50']:.0f} mm" if errors else "-",
        f"{1000 * cpu['p50']:.0f} ms" if cpu else "-",
    )


def print_parameters(parameters: dict[str, Any]) -> None:
    """Print what the figures depend on, a line for each room."""
    print_pairs(_lines(parameters))


def _lines(parameters: dict[str, Any]) -> Iterator[tuple[str, str]]:
    for name, value in parameters.items():
        if not isinstance(value, dict):
            yield name, str(value)
        elif any(isinstance(inner, dict) for inner in value.values()):
            yield from _lines(value)
        else:
            yield name, ", ".join(f"{key} {number}" for key, number in value.items())
