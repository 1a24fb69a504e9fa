"""``make fuzz``: every parser gets strange bytes for a minute; fails if one breaks, or takes too much memory.

The minute is the processor's, so that a busy machine tries as much, later. What reaches lines that nothing in the
corpus did is added to it.
"""

import argparse
import logging
import multiprocessing
import os
import sys
import time
from dataclasses import dataclass

from tests.studies.fuzz import corpus
from tests.studies.fuzz.hunt import KEPT_MAX, Findings, hunt, smallest_set
from tests.studies.fuzz.target import KIB
from tests.studies.fuzz.targets import TARGETS

_HEADER = f"{'parser':<20}{'executions':>12}{'a second':>10}{'arcs':>7}{'corpus':>8}{'peak KiB':>10}{'kept KiB':>10}  "


@dataclass(frozen=True, slots=True)
class _Job:
    name: str
    seconds: float
    seed: int


def main() -> None:
    """Hunt on all cores and print a line for each parser as it is done."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--seconds", type=float, default=60.0, help="of the processor, for each parser (default: %(default)s)"
    )
    parser.add_argument("--seed", type=int, default=time.time_ns() % 2**32, help="of the changes (default: the time)")
    parser.add_argument("--only", choices=sorted(TARGETS), help="one parser")
    arguments = parser.parse_args()
    names = [arguments.only] if arguments.only else list(TARGETS)
    print(f"fuzzing {len(names)} parsers, {arguments.seconds:g} s each, seed {arguments.seed}")
    print(_HEADER)
    jobs = [_Job(name, arguments.seconds, arguments.seed) for name in names]
    with multiprocessing.get_context("spawn").Pool(min(os.cpu_count() or 1, len(jobs))) as pool:
        failures = [wrong for job, found in pool.imap(_hunted, jobs) if (wrong := _tell(job, found))]
    for failure in failures:
        print(f"\n{failure}", file=sys.stderr)
    sys.exit(bool(failures))


def _hunted(job: _Job) -> tuple[_Job, Findings]:
    logging.getLogger().addHandler(logging.NullHandler())  # what a daemon logs is not of interest
    target = TARGETS[job.name]
    findings = hunt(target, corpus.load(job.name), seconds=job.seconds, seed=job.seed)
    if findings.broken is None:
        corpus.save(job.name, smallest_set(target, findings.corpus))
    return job, findings


def _tell(job: _Job, found: Findings) -> str | None:
    """Print the line of a parser and return what is wrong with it."""
    wrong = None
    if found.broken is not None:
        wrong = f"{job.name} breaks on {found.broken[0].hex()}\n{found.broken[1]}"
    elif found.peak_bytes > TARGETS[job.name].peak_max:
        wrong = f"{job.name} takes {found.peak_bytes} bytes for one input, allowed are {TARGETS[job.name].peak_max}"
    elif found.kept_bytes > KEPT_MAX:
        wrong = f"{job.name} keeps {found.kept_bytes} bytes of a flood, allowed are {KEPT_MAX}"
    rate = found.executions / max(job.seconds, 1e-9)
    row = f"{job.name:<20}{found.executions:>12}{rate:>10.0f}{found.arcs:>7}{len(found.corpus):>8}"
    memory = f"{found.peak_bytes / KIB:>10.0f}{found.kept_bytes / KIB:>10.1f}"
    print(f"{row}{memory}  {'FAILED' if wrong else 'ok'}", flush=True)
    return wrong


if __name__ == "__main__":
    main()
