"""The graph of stops solved, clean and with false loops among its loops."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from robotd.slam.graph import EdgeKind
from robotd.slam.solve import solve
from tests.benchmarks.timing import Timing, timed
from tests.support.chains import GROUP, edges_of, false_groups, false_loops, start_of, truth_of

STOPS = 1000


def timings() -> Iterator[Timing]:
    """A thousand stops round and round a square; how far false loops move what the others say."""
    random = np.random.default_rng(0)
    truth = truth_of(STOPS)
    edges = edges_of(truth, random)
    start = start_of(edges, STOPS)
    clean = solve(start, edges)
    off_m = np.hypot(*(clean.poses - truth)[:, :2].T)
    note = f"{len(edges)} edges; off the truth by {1000 * off_m.mean():.0f} mm in the mean"
    yield replace(timed(f"solve, {STOPS} stops", partial(solve, start, edges), 5, goal_ms=500.0), note=note)
    loops = sum(edge.kind is EdgeKind.LOOP for edge in edges)
    for share, in_groups in ((0.2, False), (0.5, False), (0.8, False), (0.2, True)):
        count = round(loops * share / (1.0 - share))
        false = false_groups(truth, count // GROUP, random) if in_groups else false_loops(truth, count, random)
        among = [*edges, *false]
        found = solve(start, among)
        moved_m = np.hypot(*(found.poses - clean.poses)[:, :2].T).max()
        right = sum(at < len(edges) for at in found.refused)
        note = (
            f"{len(false)} false: the map moves by {1000 * moved_m:.0f} mm at most; refused are "
            f"{len(found.refused) - right} of these and {right} of {loops} right ones"
        )
        yield replace(
            timed(
                f"solve, {100 * share:.0f} % of the loops false{f', {GROUP} agree' if in_groups else ''}",
                partial(solve, start, among),
                3,
            ),
            note=note,
        )
