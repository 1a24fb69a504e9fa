"""Headings in batches, so that the counters of a map of any size fit into a stated memory."""

from collections.abc import Iterator, Sequence

from robotd.localization.count.rank_grid import bits_of
from robotd.localization.obstacles.prepared_map import PreparedMap

MEMORY_BYTES = 1 << 28
"""256 MiB."""


def heading_batches(
    the_map: PreparedMap, readings: int, headings_rad: Sequence[float], memory_bytes: int
) -> Iterator[tuple[int, Sequence[float]]]:
    """Yield headings in batches whose counters take no more than this much memory, each after its first one's number.

    A batch has one heading at least, whatever that takes.
    """
    batch = max(1, memory_bytes // max(1, the_map.packed.counter_bytes(1, bits_of(readings))))
    for first in range(0, len(headings_rad), batch):
        yield first, headings_rad[first : first + batch]
