"""What ``robotctl eval`` reported, as a page."""

import datetime as dt
from collections import Counter
from collections.abc import Sequence
from typing import Any

_HEAD = """# How often right, and how often sure and wrong: {day}

`make truth` on commit {commit}, as everything is set, nothing known beforehand: scans of recorded logs,
sought on the map that others make ([what is asked, what is told](../evaluation.md)). *Right* is localized within 0.3 m
and 5 degrees; *near* a case has a scan of the map within 1 m and 45 degrees. Processor time is that of all threads, on
{machine}, whatever else that was busy with.

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


def page(day: dt.date, reports: Sequence[dict[str, Any]], looked_at: Sequence[str], machine: str) -> str:
    """Return the page of the reports of a day: one line each, in their order."""
    logs = {report["log"].partition(".")[0] for report in reports}
    head = _HEAD.format(
        day=day,
        machine=machine,
        commit=", ".join(sorted({report["commit"] for report in reports})) or "none",
        looked_at=", ".join(sorted(logs & set(looked_at))) or "none",
        new=", ".join(sorted(logs - set(looked_at))) or "none",
    )
    lines = [_line(_COLUMNS), _line(["---"] * len(_COLUMNS)), *(_line(_cells(report)) for report in reports)]
    return head + "\n".join([*lines, "", *_calibration(reports)]) + "\n"


def _calibration(reports: Sequence[dict[str, Any]]) -> list[str]:
    """Return whether belief means what it says; not on another building's map, where no answer is right."""
    said: Counter[float] = Counter()
    right: Counter[float] = Counter()
    for report in reports:
        if report["protocol"].startswith("other="):
            continue
        for line in report["calibration"]:
            said[line["belief"][0]] += line["cases"]
            right[line["belief"][0]] += line["right"]
    rows = [
        _line([f"{100 * low:.0f} to {100 * low + 10:.0f} %", str(said[low]), f"{100 * right[low] / said[low]:.0f} %"])
        for low in sorted(said)
    ]
    head = "What the best answer's belief was, and how often that answer is right, on maps of the same building:"
    return [head, "", _line(["belief said", "cases", "best answer right"]), _line(["---"] * 3), *rows]


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
