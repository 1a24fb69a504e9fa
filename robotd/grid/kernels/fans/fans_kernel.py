"""Counting poses that cannot be excluded: what the kernel does."""

from collections.abc import Sequence
from typing import Protocol

from robotd.grid.fans import FanBeams
from robotd.grid.kernels.shared.packed_map import PackedMap, Words


class FansKernel(Protocol):
    """Counting poses that cannot be excluded."""

    def count_fans(
        self,
        counters: Words,
        the_map: PackedMap,
        grown: Sequence[Words],
        fan_beams: FanBeams,
        *,
        subtract: bool = False,
        threads: int = 1,
    ) -> None:
        """Count every beam at every free cell whose fan lets a path through and whose head may be an obstacle.

        Args:
            counters: ``uint64[tiles, headings, bits, 32]``, bit-sliced, changed in place; the caller makes sure that no
                count outgrows its bits.
            the_map: where the robot may be, and what surely stops a beam; its grown cells are not used.
            grown: what may end a beam, grown by several radii, packed as the map.
            fan_beams: the beams.
            subtract: take beams back that were counted before.
            threads: how many threads share the tiles, where they can be shared; the result does not depend on it.

        O(cells / 64) for every cell of every window and for every beam.
        """
