"""The report of a log as a table for people, and all logs in one."""

import math
from collections.abc import Iterator
from typing import Any

from rich.table import Table
from rich.text import Text

from robotd.cli.show.terminal import out, print_pairs
from robotd.evaluation.log_report import LogReport
from robotd.evaluation.quantiles import PERCENTILES, Quantiles
from robotd.evaluation.tally import Tally
from robotd.evaluation.verdict import CaseVerdict

_WORDS = {
    CaseVerdict.RIGHT: "right",
    CaseVerdict.WRONG_AND_SURE: "wrong and sure",
    CaseVerdict.AMBIGUOUS: "ambiguous",
    CaseVerdict.LOST: "lost",
}
_CPU = [f"CPU {percent} %" if percent < 100 else "most" for percent in PERCENTILES]


def print_report(report: LogReport) -> None:
    """Print what became of the cases of one log."""
    spec = report.map.spec
    size = f"{spec.cols} x {spec.rows} cells of {spec.resolution_m * 1000:g} mm"
    done = f"{report.tally.cases} cases" if not report.is_cut else _so_far(report)
    title = f"{report.name}: {done}; map of {report.map_scans} of {report.scans} scans, {size}"
    out().print(Text(title, style="bold"))
    shares = Table.grid(padding=(0, 2))
    for words, share in _shares(report.tally):
        shares.add_row(Text(f"  {words}"), Text(f"{100 * share:5.1f} %"))
    out().print(shares)
    out().print(_percentile_table(report.tally))
    print_calibration(report.tally)


def _so_far(report: LogReport) -> str:
    return f"interrupted after {report.tally.cases} of {report.asked} cases"


def _shares(tally: Tally) -> list[tuple[str, float]]:
    shares = [(words, tally.share(tally.verdicts[verdict])) for verdict, words in _WORDS.items()]
    with_truth = tally.share(tally.ambiguous_with_truth)
    return [*shares[:3], ("  of these with the truth among the answers", with_truth), *shares[3:]]


def _percentile_table(tally: Tally) -> Table:
    heads = [f"{percent} %" if percent < 100 else "most" for percent in PERCENTILES]
    table = Table("", *heads, box=None, header_style="dim")
    for column in table.columns[1:]:
        column.justify = "right"
    lines: tuple[tuple[str, Quantiles, float, str], ...] = (
        ("position error of the right [mm]", tally.error_m, 1000.0, ".0f"),
        ("heading error of the right [deg]", tally.error_rad, math.degrees(1.0), ".2f"),
        ("processor time of a case [ms]", tally.cpu_s, 1000.0, ".0f"),
        ("time to the answer [ms]", tally.wall_s, 1000.0, ".0f"),
    )
    for name, quantiles, scale, form in lines:
        told = quantiles.told()
        table.add_row(
            Text(name), *(format(scale * value, form) for value in told.values()) if told else ["-"] * len(heads)
        )
    return table


def print_calibration(tally: Tally) -> None:
    """Print whether belief means what it says: of the cases whose best answer has such a belief, how many are right."""
    if not tally.said:
        return
    table = Table("belief said", "cases", "best answer right", box=None, header_style="dim")
    for column in table.columns[1:]:
        column.justify = "right"
    for tenth, cases in sorted(tally.said.items()):
        table.add_row(
            Text(f"{10 * tenth} to {10 * tenth + 10} %"), str(cases), f"{100 * tally.said_right[tenth] / cases:.1f} %"
        )
    out().print(table)


def print_summary(reports: list[LogReport]) -> None:
    """Print one line for each log, one for all their cases together, and what belief means in all of them."""
    table = Table(
        *("log", "cases", *_WORDS.values(), "with truth", "right nearby", "error", *_CPU), box=None, header_style="bold"
    )
    for column in table.columns[1:]:
        column.justify = "right"
    for report in reports:
        _add_summary(table, f"{report.name} {1000 * report.map.spec.resolution_m:g} mm", report.tally)
    _add_summary(table, "all", Tally.of(report.tally for report in reports))
    out().print(table)
    # On another building's map no answer is right, whatever belief it has.
    print_calibration(Tally.of(report.tally for report in reports if not report.protocol.startswith("other=")))


def _add_summary(table: Table, name: str, tally: Tally) -> None:
    def share(count: int) -> str:
        return f"{100 * tally.share(count):.1f} %" if tally.cases else "-"

    def middle(quantiles: Quantiles, unit: str) -> str:
        return f"{1000 * quantiles.percentile(50):.0f} {unit}" if len(quantiles) else "-"

    table.add_row(
        Text(name),
        str(tally.cases),
        *(share(tally.verdicts[verdict]) for verdict in _WORDS),
        share(tally.ambiguous_with_truth),
        f"{100 * tally.near_right / tally.near:.1f} % of {tally.near}" if tally.near else "-",
        middle(tally.error_m, "mm"),
        *(f"{1000 * value:.0f} ms" for value in (tally.cpu_s.told() or {}).values()),
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
