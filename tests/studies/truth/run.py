"""``make truth``: all ways to ask, of all recorded logs found, by ``robotctl eval`` as it is set; a page of a day.

What was answered is kept in ``build/truth``: ended and begun again with the same program, it goes on where it was.
"""

import argparse
import datetime as dt
import json
import os
import sys
from pathlib import Path
from typing import Any

from robotd.cli.main import main as robotctl
from robotd.evaluation.degrade import KINDS
from tests.studies.truth.page import page
from tests.support.this_machine import processor

ROOT = Path(__file__).parents[3]
LOOKED_AT = ("intel", "fr079", "edmonton", "infinite-corridor")
"""What the engine was built by; every other log that is found is asked as well, and the page says that it is new."""


def main(words: list[str] | None = None) -> None:
    """Ask and write; fails if one robot is sure and wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, default=os.environ.get("ROBOTD_DATA"), help="where logs are looked for")
    parser.add_argument("--share", type=float, default=1.0, help="of the cases (default: all)")
    parser.add_argument("--only", choices=("cells", "half", "other", "degraded"), help="one way to ask (default: all)")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="processes (default: %(default)s)")
    parser.add_argument("--kept", type=Path, default=ROOT / "build" / "truth", help="what was answered")
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "truth", help="where the page goes")
    arguments = parser.parse_args(words)
    if arguments.data is None:
        parser.error("no logs: set ROBOTD_DATA to a directory of recorded logs, or name it by --data")
    logs = sorted(arguments.data.rglob("*.corrected.log*"))
    if not logs:
        parser.error(f"there is no *.corrected.log in {arguments.data}")
    reports = [
        report
        for name, asked in questions(logs, arguments.share).items()
        if arguments.only in (None, name.partition("-")[0])
        for report in _asked(arguments.kept / f"{name}.jsonl", asked, arguments.workers)
    ]
    today = dt.datetime.now(tz=dt.UTC).date()
    arguments.out.mkdir(parents=True, exist_ok=True)
    (arguments.out / f"{today}.md").write_text(
        page(today, reports, LOOKED_AT, f"{processor()}, {os.cpu_count()} cores")
    )
    sys.exit(any(report["wrong_and_sure"] for report in reports))


def questions(logs: list[Path], share: float) -> dict[str, list[str]]:
    """Return what ``robotctl eval`` is asked, by the name of the file that keeps its answers."""

    def cases(whole: int) -> list[str]:
        return ["--cases", str(max(1, round(share * whole)))]

    every = [str(log) for log in logs]
    kinds = [word for kind in KINDS for word in ("--protocol", f"degrade={kind}")]
    asked = {
        "cells": [*every, "--resolution", "0.05", "0.1", "0.2", *cases(100)],
        "half": [*every, "--protocol", "half", *cases(100)],
        "degraded": [*every, *kinds, *cases(30)],
    }
    for log in logs:
        others = [word for other in logs if other != log for word in ("--protocol", f"other={other}")]
        if others:
            asked[f"other-{log.name}"] = [str(log), *others, *cases(100)]
    return asked


def _asked(file: Path, words: list[str], workers: int) -> list[dict[str, Any]]:
    """Return what became of each log in each way, from the file of lines."""
    file.parent.mkdir(parents=True, exist_ok=True)
    if robotctl(["eval", *words, "--workers", str(workers), "--json", str(file), "--resume"]) != 0:
        sys.exit("robotctl eval was ended; begun again, it goes on where it was")
    documents: list[dict[str, Any]] = [json.loads(line) for line in file.read_text().splitlines()]
    commit = documents[0]["parameters"]["commit"]
    return [document | {"commit": commit} for document in documents if "asked" in document]


if __name__ == "__main__":
    main()
