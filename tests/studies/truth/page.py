"""What ``robotctl eval`` reported, as a page."""

import datetime as dt
from collections.abc import Sequence
from typing import Any

_HEAD = """# How often right, and how often sure and wrong: {day}

`make truth` on commit {commit}, as everything is set, nothing known beforehand: scans of recorded logs,
sought on the map that others make. *Right* is localized within 0.3 m and 5 degrees; *near* a case has a scan of the
map within 1 m and 45 degrees. Processor time is that of all threads, on whatever machine this was.

Looked at while the engine was built: {looked_at}. Not looked at: {new}.

"""
_COLUMNS = (
    "asked",
    "log",
    "cells",
    "cases",
    "right",
    "sure and wrong",
    "ambiguous",
    "of these with the truth",
    "lost",
    "right of those near",
    "error, middle",
    "processor time, 50 / 90 / 99 % / most",
)


def page(day: dt.date, reports: Sequence[dict[str, Any]], looked_at: Sequence[str]) -> str:
    """Return the page of the reports of a day: one line each, in their order."""
    logs = {report["log"].partition(".")[0] for report in reports}
    head = _HEAD.format(
        day=day,
        commit=", ".join(sorted({report["commit"] for report in reports})) or "none",
        looked_at=", ".join(sorted(logs & set(looked_at))) or "none",
        new=", ".join(sorted(logs - set(looked_at))) or "none",
    )
    lines = [_line(_COLUMNS), _line(["---"] * len(_COLUMNS)), *(_line(_cells(report)) for report in reports)]
    return head + "\n".join(lines) + "\n"


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _cells(report: dict[str, Any]) -> list[str]:
    cases, ambiguous = report["cases"], report["ambiguous"]
    return [
        report["protocol"],
        report["log"].partition(".")[0],
        f"{100 * report['map']['resolution_m']:g} cm",
        str(cases),
        f"{100 * report['right']:.1f} %",
        str(round(cases * report["wrong_and_sure"])),
        f"{100 * ambiguous:.1f} %",
        f"{100 * report['ambiguous_with_truth'] / ambiguous:.0f} %" if ambiguous else "-",
        f"{100 * report['lost']:.1f} %",
        f"{report['near_right']} of {report['near']}" if report["near"] else "-",
        f"{1000 * report['error_m']['p50']:.0f} mm" if report["error_m"] else "-",
        _times(report["cpu_s"]),
    ]


def _times(cpu_s: dict[str, float] | None) -> str:
    return "-" if cpu_s is None else f"{' / '.join(f'{1000 * time_s:.0f}' for time_s in cpu_s.values())} ms"
