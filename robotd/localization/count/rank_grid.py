"""How many readings each pose explains: the paper's rnk(M, Z, p), counted reading by reading or many at once.

[BrownDonald2000]_ sec. 2.2.1 (consistent readings), 2.2.3 (theta slices), 2.3.3. What is counted is defined by
:mod:`robotd.localization.reference.feasible_poses`; how, by :mod:`robotd.grid.kernels`.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robotd.core.errors import TooLarge
from robotd.grid import kernels
from robotd.grid.kernels.draw.draw_kernel import BeamSettings, turned
from robotd.grid.kernels.shared.packed_map import PAD_WORDS, TILE_ROWS, WORD_CELLS, unpack
from robotd.grid.pose_set import PoseSet
from robotd.grid.readings import Readings
from robotd.localization.obstacles.levels import Levels
from robotd.localization.obstacles.prepared_map import PreparedMap

_READINGS_MAX = int(np.iinfo(np.uint16).max)
_BITS_AT_FIRST = 9
"""A sweep of 300 readings fits; counters that must hold more are widened."""

_BYTES_MAX = 1 << 30
"""A rank grid that would be larger is refused."""

_WORTH_THREADS = 1000
"""Fewer beams than this are counted sooner than a thread is started."""


class RankGrid:
    """Counts feasible readings for every cell and every heading; it can be looked at after any of them.

    Only free cells are poses; the rank of all others stays 0.

    The counts of 2048 cells (a tile of 32 x 64 with a free cell in it), at one heading, take 256 bytes for every binary
    digit, of which there are nine up to 511 readings: 300 headings of a room of 7 x 9 m at 50 mm take 10 MB, of
    256 x 256 free cells 22 MB, of 1024 x 1024 free cells 350 MB. More than 1 GiB is refused: larger maps are
    searched, or counted a batch of headings at a time (:mod:`.heading_batches`).
    """

    def __init__(self, the_map: PreparedMap, headings_rad: Sequence[float], *, threads: int = 1) -> None:
        """Begin with no readings.

        Args:
            the_map: the map; what is derived from it is shared, nothing is copied.
            headings_rad: the headings to try, map frame: one where it is known, else the theta slices.
            threads: how many threads may share the counting; the counts do not depend on it.

        Raises:
            TooLarge: the counts would take more than 1 GiB.
        """
        self.spec = the_map.spec
        self.headings_rad = tuple(headings_rad)
        self.readings = 0
        self._headings = turned(np.array(self.headings_rad, np.float64))
        self._threads = threads
        self._the_map = the_map
        self._map = the_map.packed
        row, col = the_map.packed.origin
        self._first_cell = row + the_map.obstacles.rim, col + the_map.obstacles.rim
        # Before anything is allocated: the kernel of the operating system would only notice when the pages are
        # touched.
        self._refuse_if_too_large(bits_of(0))
        self._counters = self._map.blank_counters(len(self.headings_rad), bits_of(0))

    def add(self, readings: Readings, on: PreparedMap | None = None) -> None:
        """Count readings; many at once cost less than one after the other.

        O(directions x cells / 64 x length of the longest beam in cells + readings x headings x cells / 64), where the
        directions are those of all readings at all headings.

        Args:
            readings: hits and misses.
            on: the same map, prepared for another error radius, if these have another.

        Raises:
            ValueError: there are more than 65535; then none was counted.
            TooLarge: the counts of this many readings would take more than 1 GiB; then none was counted.
        """
        # Checked here and not in the kernel, whose counters would wrap without a word.
        if self.readings + len(readings) > _READINGS_MAX:
            raise ValueError(f"a rank grid counts {_READINGS_MAX} readings")
        self._count(readings, on or self._the_map, subtract=False)

    def add_by_level(self, readings: Readings, levels: Levels) -> None:
        """Count readings each with the error radius of its range, on the map that this was made for; as :meth:`add`."""
        for the_map, which in levels.parted(readings):
            self.add(readings[which], the_map)

    def remove(self, readings: Readings, on: PreparedMap | None = None) -> None:
        """Take back readings that were added, in any order; costs what adding them did.

        Which readings were added is not remembered: taking back others leaves counts that mean nothing.

        Raises:
            ValueError: more are taken back than were added; then nothing was.
        """
        if len(readings) > self.readings:
            raise ValueError(f"{len(readings)} readings cannot be taken back of {self.readings}")
        self._count(readings, on or self._the_map, subtract=True)

    def _count(self, readings: Readings, on: PreparedMap, *, subtract: bool) -> None:
        if len(readings) == 0:
            return
        total = self.readings + (-len(readings) if subtract else len(readings))
        # First the room, which may be refused: then the counters are as they were, and the total, too.
        self._make_room(bits_of(total))
        self._count_with_room(readings, on, subtract=subtract)
        self.readings = total

    def _count_with_room(self, readings: Readings, on: PreparedMap, *, subtract: bool) -> None:
        """Count readings for which the counters have room."""
        how = BeamSettings(self.spec.resolution_m, on.error_radius_cells, 2 * max(self.spec.shape))
        beams = kernels.in_use().draw.draw_beams(readings.rows, self._headings, how)
        threads = self._threads_for(len(readings) * len(self.headings_rad))
        kernels.in_use().count.count_feasible(self._counters, on.packed, beams, subtract=subtract, threads=threads)

    def _threads_for(self, beams: int) -> int:
        """Return how many threads are worth starting."""
        return self._threads if beams >= _WORTH_THREADS else 1

    def _make_room(self, bits: int) -> None:
        """Widen the counters so that they hold numbers of this many bits."""
        missing = bits - self._counters.shape[2]
        if missing > 0:
            self._refuse_if_too_large(bits)
            # New planes at the top are zeros: the counts stay what they are.
            self._counters = np.pad(self._counters, ((0, 0), (0, 0), (0, missing), (0, 0)))

    def _refuse_if_too_large(self, bits: int) -> None:
        needed = self._map.counter_bytes(len(self.headings_rad), bits)
        if needed > _BYTES_MAX:
            raise TooLarge(
                f"counting up to {(1 << bits) - 1} readings at {len(self.headings_rad)} headings on a map of "
                f"{self.spec.rows} x {self.spec.cols} cells takes {needed / 2**30:.1f} GiB; at most "
                f"{_BYTES_MAX / 2**30:.1f} GiB"
            )

    @property
    def rank(self) -> NDArray[np.uint16]:
        """The count, a new array ``uint16[headings, rows, cols]``."""
        rank = np.zeros((len(self.headings_rad), *self.spec.shape), np.uint16)
        tiled = np.zeros((len(self.headings_rad), self._map.rows, self._map.words), np.uint64)
        blocks = tiled.reshape(len(self.headings_rad), -1, TILE_ROWS, self._map.words)
        (top, left), (rows, cols) = self._first_cell, self.spec.shape
        for bit in range(self._counters.shape[2]):
            blocks[:, self._map.tiles[:, 1] // TILE_ROWS, :, self._map.tiles[:, 0]] = self._counters[:, :, bit]
            cells = unpack(tiled[:, top : top + rows], left + cols)[:, :, left:]
            rank |= cells.astype(np.uint16) << bit
        return rank

    def heat(self, block: int = 1) -> NDArray[np.uint8]:
        """Return how many readings each cell explains at its best heading, ``uint8[rows / block, cols / block]``.

        255 is all of them, 0 none or not one in 255; a level is that of the best of ``block x block`` cells.
        """
        readings = max(1, self.readings)
        return kernels.in_use().count.heat(
            self._counters, self._map, self._first_cell, self.spec.shape, readings=readings, block=block
        )

    @property
    def best_rank(self) -> int:
        """The greatest count (the paper's kappa)."""
        return kernels.in_use().count.greatest(self._counters)

    def cells_of_rank(self, least: int) -> NDArray[np.intp]:
        """Return the poses that explain at least this many readings, in order.

        They are ``intp[n, 3]`` as ``(heading, row, col)``.

        Only free cells are poses, even for a rank of 0.
        """
        # On counters as they lie, 64 cells a word: to unpack all counts first would be sixteen times the
        # memory.
        reached = kernels.in_use().count.at_least(self._counters, self._map, max(least, 0))
        if least <= 0:
            # Every count reaches 0, also those of the cells beside free ones in a tile.
            reached &= self._map.free[PAD_WORDS:-PAD_WORDS, TILE_ROWS:-TILE_ROWS].T
        heading, row, word = np.nonzero(reached)
        which, bit = np.nonzero(unpack(reached[heading, row, word][:, None], WORD_CELLS))
        poses = np.stack((heading[which], row[which], word[which] * WORD_CELLS + bit), axis=1)
        poses -= np.array([0, *self._first_cell])
        return poses

    def count_of_rank(self, least: int) -> int:
        """Return how many poses explain at least this many readings, one or more."""
        reached = kernels.in_use().count.at_least(self._counters, self._map, max(least, 1))
        return int(np.unpackbits(reached[reached != 0].view(np.uint8)).sum())

    def rank_at(self, poses: NDArray[np.intp]) -> NDArray[np.uint16]:
        """Return the counts ``uint16[n]`` of poses that :meth:`cells_of_rank` returned."""
        heading, row, col = poses.T
        row, col = row + self._first_cell[0], col + self._first_cell[1]
        number = np.zeros((self._map.words, self._map.rows // TILE_ROWS), np.intp)
        number[self._map.tiles[:, 0], self._map.tiles[:, 1] // TILE_ROWS] = np.arange(len(self._map.tiles))
        tile = number[col // WORD_CELLS, row // TILE_ROWS]
        words = self._counters[tile, heading, :, row % TILE_ROWS]
        bits = words >> (col % WORD_CELLS).astype(np.uint64)[:, None] & np.uint64(1)
        ranks: NDArray[np.uint16] = (bits << np.arange(bits.shape[1], dtype=np.uint64)).sum(axis=1).astype(np.uint16)
        return ranks

    def best_poses(self, slack: int = 0, least_rank: int = 1) -> PoseSet:
        """Return the poses of greatest rank (the paper's loc), and those that come near them.

        Args:
            slack: poses that explain this many readings fewer than the best are wanted, too.
            least_rank: if no pose explains this many readings, none is returned.
        """
        best_rank = self.best_rank
        if best_rank < max(1, least_rank):
            return PoseSet.nothing()
        least = max(1, best_rank - slack)
        poses = self.cells_of_rank(least)
        return PoseSet(poses, self.rank_at(poses), best_rank, least)


def bits_of(readings: int) -> int:
    """Return how many binary digits the counts of this many readings have."""
    return max(_BITS_AT_FIRST, readings.bit_length())
