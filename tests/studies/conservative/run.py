"""``make conservative``: seeded cases of the promise that the true pose is never lost; fails if one is."""

import argparse
import sys
from collections.abc import Sequence

import numpy as np

from robotd.core.grid_spec import GridSpec
from robotd.grid.readings import Readings
from robotd.localization.conservative.conservative_poses import ErrorBounds, SureObstacles
from robotd.localization.conservative.conservative_rank import ConservativeMap, ConservativeRankGrid
from robotd.localization.even_headings import even_headings
from tests.support.conservative_cases import Case, case_of


def ranks_of(case: Case, headings_rad: Sequence[float], *, share_of_bounds: float = 1.0) -> ConservativeRankGrid:
    """Return the blank counts of a case; with a share of less than one, the bounds are broken."""
    spec = GridSpec(case.resolution_m, 0.0, 0.0, case.occupied.shape)
    bounds = ErrorBounds(case.range_error_m * share_of_bounds, case.heading_error_rad * share_of_bounds)
    the_map = ConservativeMap.of(SureObstacles.of(case.occupied), spec, bounds)
    return ConservativeRankGrid(the_map, headings_rad)


def is_lost(case: Case, *, share_of_bounds: float = 1.0) -> bool:
    """Whether a reading excludes the true pose; only its slice is looked at."""
    ranks = ranks_of(case, even_headings(case.slices)[case.slice_number :][:1], share_of_bounds=share_of_bounds)
    ranks.add(Readings.of(case.readings))
    return int(ranks.rank[0][case.cell]) < ranks.readings


def main() -> None:
    """Run the cases and print what came of them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=10_000, help="how many (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="of the first case (default: %(default)s)")
    arguments = parser.parse_args()
    lost, readings, cells, shares = [], 0, [], []
    for seed in range(arguments.seed, arguments.seed + arguments.cases):
        case = case_of(seed)
        ranks = ranks_of(case, even_headings(case.slices))
        ranks.add(Readings.of(case.readings))
        poses = ranks.cells_of_rank(ranks.readings)
        if not (poses == (case.slice_number, *case.cell)).all(axis=1).any():
            lost.append(seed)
            print(f"lost: case {seed}", file=sys.stderr)
        readings += ranks.readings
        cells.append(len(np.unique(poses[:, 1:], axis=0)))
        shares.append(len(poses) / (case.slices * np.count_nonzero(~case.occupied)))
    print(
        f"conservative mode: {len(cells)} cases, {readings} readings, {len(lost)} misses; "
        f"median region {np.median(cells):g} cells, {np.median(shares):.1%} of all poses"
    )
    sys.exit(bool(lost))


if __name__ == "__main__":
    main()
