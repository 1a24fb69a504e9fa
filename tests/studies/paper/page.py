"""The page that ``make paper`` writes: prose from ``page.md.template``, tables from the very same run."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from string import Template

import numpy as np
from numpy.typing import NDArray

from tests.studies.paper.figures import FIGURES
from tests.studies.paper.robot import CUT_OFF_M, TILT_RAD
from tests.studies.paper.rooms import LABORATORY, OFFICE, TESTS, Test
from tests.studies.paper.study import FOUND_WITHIN_M, POSES_A_MAP, PROBES, Tally
from tests.studies.paper.trials import COUNTED, ERROR_M, PAPERS, Manner, Outcome
from tests.studies.paper.why import POSES, Why

Results = Mapping[tuple[int, str, int], Outcome]
"""By test, name of the manner, and seed."""

TEST_HEAD = (
    "test",
    "room",
    "probes",
    "in range (paper)",
    "counted",
    "consistent at best (paper)",
    "regions",
    "cells",
    "largest off by [mm]",
    "nearest off by [mm]",
    "within the robot",
)


def page_of(results: Results, tallies: Sequence[Tally], why: Sequence[Why], seeds: Sequence[int]) -> str:
    """Return the whole page."""
    template = Template(Path(__file__).with_name("page.md.template").read_text(encoding="utf-8"))
    return template.substitute(
        tilt=-TILT_RAD,
        cut_off=CUT_OFF_M,
        office_stops=1 + len(OFFICE.stops_m),
        laboratory_stops=1 + len(LABORATORY.stops_m),
        error=f"{1000 * ERROR_M:g}",
        seeds=_list(seeds),
        papers=_tests(results, PAPERS, seeds[0]),
        counted=_tests(results, COUNTED, seeds[0]),
        test_pictures="\n\n".join(f"![test {test.number}](test-{test.number}.png)" for test in TESTS),
        spread=_spread(results, seeds),
        poses=POSES_A_MAP,
        maps=len(seeds),
        probes=PROBES,
        found_within=FOUND_WITHIN_M,
        study=table(_STUDY_HEAD, map(_study_row, tallies)),
        why=table(_WHY_HEAD, map(_why_row, why)),
        why_poses=POSES,
        figures="\n\n".join(f"![{title}]({name}.png)" for name, (title, _) in FIGURES.items()),
    )


def _tests(results: Results, manner: Manner, seed: int) -> str:
    return table(TEST_HEAD, (test_row(test, results[test.number, manner.name, seed]) for test in TESTS))


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    lines = (head, ["---"] * len(head), *rows)
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def test_row(test: Test, outcome: Outcome) -> tuple[str, ...]:
    """Return the row of one test."""
    return (
        str(test.number),
        test.room.name,
        str(outcome.probes),
        f"{outcome.in_range} ({test.in_range})",
        str(outcome.counted),
        f"{outcome.consistent} ({test.consistent})",
        str(len(outcome.errors_m)),
        str(outcome.cells),
        f"{1000 * outcome.largest_off_m:.0f}",
        f"{1000 * outcome.nearest_off_m:.0f}",
        f"{100 * outcome.within_robot:.0f} %",
    )


def _spread(results: Results, seeds: Sequence[int]) -> str:
    head = ("test", "manner", "in range", "consistent", "regions", "largest off by [mm]", "nearest off by [mm]")
    return table(head, (_spread_row(results, test, manner, seeds) for manner in (PAPERS, COUNTED) for test in TESTS))


def _spread_row(results: Results, test: Test, manner: Manner, seeds: Sequence[int]) -> tuple[str, ...]:
    outcomes = [results[test.number, manner.name, seed] for seed in seeds]
    return (
        str(test.number),
        manner.name,
        _list(outcome.in_range for outcome in outcomes),
        _list(outcome.consistent for outcome in outcomes),
        _list(len(outcome.errors_m) for outcome in outcomes),
        _list(round(1000 * outcome.largest_off_m) for outcome in outcomes),
        _list(round(1000 * outcome.nearest_off_m) for outcome in outcomes),
    )


def _list(numbers: Iterable[int]) -> str:
    return ", ".join(str(number) for number in numbers)


_STUDY_HEAD = (
    "room",
    "over-range readings",
    "found",
    "found by one of the regions",
    "found, and no region elsewhere",
    "median error [mm]",
    "95th percentile [mm]",
    "the planner lets it stand there",
    "found of those",
)


def _study_row(tally: Tally) -> tuple[str, ...]:
    # As it is sorted, and not between two of them: one that was not found at all is off by infinity.
    median, high = 1000 * np.percentile(tally.largest_off_m, (50, 95), method="nearest")
    return (
        tally.room.name,
        tally.manner.name,
        _share(tally.found),
        _share(tally.nearest_off_m <= FOUND_WITHIN_M),
        _share(tally.farthest_off_m <= FOUND_WITHIN_M),
        f"{median:.0f}",
        f"{high:.0f}",
        _share(tally.on_known_floor),
        _share(tally.found[tally.on_known_floor]),
    )


_WHY_HEAD = (
    "changed",
    "stops",
    "open floor that is not known",
    "wrong obstacles on it",
    "found",
    "found by one of the regions",
)


def _why_row(why: Why) -> tuple[str, ...]:
    unknown, found, by_one = (f"{100 * share:.0f} %" for share in (why.floor_unknown, why.found, why.found_by_one))
    return why.cause.name, str(why.cause.stops), unknown, f"{why.wrong_obstacles} cells", found, by_one


def _share(which: NDArray[np.bool_]) -> str:
    return f"{100 * which.mean():.0f} %" if len(which) else "-"
