"""All poses counted, batch by batch within a stated memory, of which only the best are kept: what a search must find.

A :class:`.RankGrid` holds the counts of all headings at once, which it must if readings are to
come one by one. Where they are all there, one batch of headings after the other gives the same best poses, and the
memory is that of one batch: so maps of any size can be counted. The bounded search (:mod:`.bounded_search`)
gives the same answer sooner, by not counting what cannot be best; it is what the programs use.
"""

from collections.abc import Sequence

import numpy as np

from robotd.grid.pose_set import PoseSet
from robotd.grid.readings import Readings
from robotd.localization.count.heading_batches import MEMORY_BYTES, heading_batches
from robotd.localization.count.rank_grid import RankGrid
from robotd.localization.obstacles.prepared_map import PreparedMap


def count_all(
    the_map: PreparedMap,
    readings: Readings,
    headings_rad: Sequence[float],
    *,
    slack: int = 0,
    threads: int = 1,
    memory_bytes: int = MEMORY_BYTES,
) -> PoseSet:
    """Count all readings at every free cell and heading; the same as a rank grid would.

    Args:
        the_map: the map.
        readings: hits and misses.
        headings_rad: the headings to try, map frame.
        slack: poses that explain this many readings fewer than the best are wanted, too.
        threads: how many threads may share the counting; the answer does not depend on it.
        memory_bytes: how much the counters may take; they take no less than one heading needs.

    Raises:
        ValueError: there are more than 65535.
        TooLarge: a single heading needs more memory than a rank grid may take.
    """
    best, found = 0, []
    for first, batch_rad in heading_batches(the_map, len(readings), headings_rad, memory_bytes):
        ranks = RankGrid(the_map, batch_rad, threads=threads)
        ranks.add(readings)
        # The best so far is a bound for later headings, too: what is kept of each stays small.
        best = max(best, ranks.best_rank)
        poses = ranks.cells_of_rank(max(1, best - slack))
        found.append((poses + np.array([first, 0, 0]), ranks.rank_at(poses)))
    poses = np.concatenate([np.empty((0, 3), np.intp), *(part for part, _ in found)])
    counts = np.concatenate([np.empty(0, np.uint16), *(part for _, part in found)])
    least = max(1, best - slack)
    near = counts >= least  # what came near the best of earlier headings may not come near the best
    return PoseSet(poses[near], counts[near], best, least)
