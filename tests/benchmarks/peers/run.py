"""``make bench-peers``: localizers of others on workload S, beside ours: the same room, readings and priors.

The peers are installed into an environment that is thrown away afterwards.
"""

import argparse
import json
import platform
import subprocess
import sys
import tempfile
import venv
from datetime import UTC, datetime
from pathlib import Path
from string import Template
from typing import Any

import numpy as np

from tests.benchmarks.peers.ours import answers
from tests.benchmarks.peers.questions import Questions
from tests.benchmarks.run import ROOT, commit
from tests.support.this_machine import processor

HEAD = (
    "| who | how | mean error [mm] | median [mm] | within 0.1 m | median time [ms] | least [ms] | asked |\n"
    "|---|---|---|---|---|---|---|---|"
)
RIGHT_M = 0.1


PEERS = {"karto": "karto-scanmatcher==1.0.0", "amcl": "amcl==0.1.2"}
"""What to install for each."""


def ask(peer: str, directory: Path, questions: Path) -> list[dict[str, Any]] | str:
    """Return a peer's answers, or why there are none."""
    place = directory / peer
    venv.create(place, with_pip=True)
    python = str(place / "bin" / "python")
    install = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", PEERS[peer], "numpy"]
    installed = subprocess.run(install, capture_output=True, text=True, check=False)
    if installed.returncode:
        return f"cannot be installed here: {_last_line(installed.stderr)}"
    answer = [python, str(Path(__file__).with_name("answer.py")), peer, str(questions)]
    answered = subprocess.run(answer, capture_output=True, text=True, check=False)
    if answered.returncode:
        return f"failed with exit code {answered.returncode}: {_last_line(answered.stderr)}"
    found: list[dict[str, Any]] = json.loads(answered.stdout)
    return found


def rows_of(who: str, found: list[dict[str, Any]] | str, *, tracking: bool) -> list[str]:
    """Return the rows of one of the two tables."""
    if isinstance(found, str):
        return [f"| {who} | {found} | | | | | | |"]
    return [_row(who, answer) for answer in found if answer["tracking"] is tracking]


def _row(who: str, answer: dict[str, Any]) -> str:
    errors_m, times_ms = np.array(answer["errors_m"]), 1000 * np.array(answer["seconds"])
    right = errors_m <= RIGHT_M
    mean = f"{1000 * errors_m[right].mean():.1f}" if right.any() else "-"
    cells = (
        who,
        answer["what"],
        mean,
        f"{1000 * np.median(errors_m):.1f}",
        f"{100 * right.mean():.0f} %",
        f"{np.median(times_ms):.3g}",
        f"{times_ms.min():.3g}",
        str(len(errors_m)),
    )
    return f"| {' | '.join(cells)} |"


def _last_line(text: str) -> str:
    return (text.strip().splitlines() or ["it says nothing"])[-1].replace("|", "/")


def page(found: dict[str, list[dict[str, Any]] | str]) -> str:
    """Return the report."""
    template = Template(Path(__file__).with_name("page.md.template").read_text(encoding="utf-8"))
    return template.substitute(
        date=f"{datetime.now(UTC):%Y-%m-%d}",
        commit=commit(),
        processor=processor(),
        python=platform.python_version(),
        tracking=_table(found, tracking=True),
        anywhere=_table(found, tracking=False),
        **{f"{peer}_version": requirement for peer, requirement in PEERS.items()},
    )


def _table(found: dict[str, list[dict[str, Any]] | str], *, tracking: bool) -> str:
    return "\n".join((HEAD, *(row for who in found for row in rows_of(who, found[who], tracking=tracking))))


def main() -> None:
    """Ask everybody, print and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    file = ROOT / "docs" / "benchmarks" / "peers.md"
    parser.add_argument("--out", type=Path, default=file, help="the report (default: %(default)s)")
    out: Path = parser.parse_args().out
    questions = Questions()
    found: dict[str, list[dict[str, Any]] | str] = {"robotd": answers(questions)}
    with tempfile.TemporaryDirectory() as directory:
        saved = Path(directory) / "questions.npz"
        questions.save(saved)
        for peer, requirement in PEERS.items():
            print(f"Installing {requirement} for this run, and asking it ...", file=sys.stderr, flush=True)
            found[peer] = ask(peer, Path(directory), saved)
    report = page(found)
    print(report)
    out.write_text(report)
    print(f"written to {out}", file=sys.stderr)


if __name__ == "__main__":
    main()
