"""``make paper``: the five tests of [BrownDonald2000]_ sec. 3.2 in simulated rooms, as pictures and tables."""

import argparse
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from robotd.localization.ready_map import ReadyMap
from tests.studies.paper.figures import draw_figures
from tests.studies.paper.page import TEST_HEAD, Results, page_of, table, test_row
from tests.studies.paper.pictures import draw_test
from tests.studies.paper.robot import Tour, probes_at, tour_of
from tests.studies.paper.rooms import LABORATORY, OFFICE, TESTS, Room, Test
from tests.studies.paper.study import Tally, tally_of
from tests.studies.paper.trials import COUNTED, MANNERS, PAPERS, Outcome, outcome_of
from tests.studies.paper.why import Cause, causes

ROOT = Path(__file__).parents[3]
SEEDS = (1, 2, 3, 4, 5, 6)
ROOMS = (OFFICE, LABORATORY)

Tours = dict[Room, tuple[Tour, ...]]


def tour_in(room: Room, seed: int) -> Tour:
    """Return the tour that maps a room."""
    return tour_of(room.world, room.stops_m, seed)


def outcomes_of(test: Test, tours: tuple[Tour, ...], seeds: tuple[int, ...]) -> dict[tuple[int, str, int], Outcome]:
    """Carry out one test in each map, in both manners; the probes are the same."""
    spec = test.room.spec
    pose = test.pose_on(tours[0].map_by(PAPERS.grid, spec))
    outcomes = {}
    for seed, tour in zip(seeds, tours, strict=True):
        readings = probes_at(test.room.world, pose, test.probes, seed)
        for manner in (PAPERS, COUNTED):
            the_map = ReadyMap.of(tour.map_by(manner.grid, spec), manner.localization)
            outcomes[test.number, manner.name, seed] = outcome_of(manner, the_map, readings, pose)
    return outcomes


def _toured(pool: ProcessPoolExecutor) -> Tours:
    running = {(room, seed): pool.submit(tour_in, room, seed) for room in reversed(ROOMS) for seed in SEEDS}
    for (room, seed), tour in running.items():
        print(f"  the {room.name} mapped, seed {seed}: {len(tour.result().sweeps)} stops", flush=True)
    return {room: tuple(running[room, seed].result() for seed in SEEDS) for room in ROOMS}


def _tallied(pool: ProcessPoolExecutor, tours: Tours) -> list[Tally]:
    running = [pool.submit(tally_of, room, manner, tours[room]) for room in ROOMS for manner in MANNERS]
    tallies = []
    for future in running:
        tallies.append(future.result())
        last = tallies[-1]
        print(f"  the {last.room.name}, {last.manner.name}: found {100 * last.found.mean():.0f} %", flush=True)
    return tallies


def _rows(results: Results) -> Iterator[tuple[str, ...]]:
    return (test_row(test, results[test.number, PAPERS.name, SEEDS[0]]) for test in TESTS)


def _drawn(tours: Tours, results: Results, out: Path) -> None:
    for test in TESTS:
        grid = tours[test.room][0].map_by(PAPERS.grid, test.room.spec)
        outcome = results[test.number, PAPERS.name, SEEDS[0]]
        pose = test.pose_on(grid)
        counted = PAPERS.counted(probes_at(test.room.world, pose, test.probes, SEEDS[0]))
        draw_test(out / f"test-{test.number}.png", test, pose, grid, outcome, counted)
    draw_figures(out)


def main() -> None:
    """Run everything; write pictures and page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "paper", help="directory (default: %(default)s)")
    out: Path = parser.parse_args().out
    out.mkdir(parents=True, exist_ok=True)
    with ProcessPoolExecutor(2) as pool:
        print(f"Mapping both rooms, {len(SEEDS)} times each, daemon and all, in virtual time:")
        tours = _toured(pool)
        results: dict[tuple[int, str, int], Outcome] = {}
        for test in TESTS:
            results |= outcomes_of(test, tours[test.room], SEEDS)
        print(f"The five tests, in the paper's manner:\n{table(TEST_HEAD, _rows(results))}")
        print("Random poses all over the floor:")
        tallies = _tallied(pool, tours)
        print("What keeps the paper's manner from finding more, in the laboratory:")
        why = tuple(pool.map(Cause.measured, causes()))
    _drawn(tours, results, out)
    (out / "README.md").write_text(page_of(results, tallies, why, SEEDS))
    print(f"Written to {out}: README.md and {len(list(out.glob('*.png')))} pictures")


if __name__ == "__main__":
    main()
