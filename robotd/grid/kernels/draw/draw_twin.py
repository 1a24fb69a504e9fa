"""Beams drawn on the grid, in NumPy: the twin of the kernel in C.

Readings and headings that are multiples of one step share their directions: 300 x 300 beams run along 300 chains of
cells. Directions count as one only if that is proved: a coordinate of a chain's cell is ``floor(0.5 + k * step)``,
which never falls as the step grows, so a chain that is the same for the smallest and for the greatest step of a
group is the same for all of it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.grid.drawn import Drawn
from robotd.grid.kernels.draw.draw_kernel import NO_HEAD, SLOTS, BeamCounts, Beams, BeamSettings
from robotd.grid.readings import Readings

_DIRECTIONS = 1 << 30
"""Directions nearer than this share of a turn are tried as one."""

Ints = NDArray[np.int64]


def draw_beams(readings: NDArray[np.float64], headings: NDArray[np.float64], how: BeamSettings) -> Beams:
    """See :class:`.DrawKernel`."""
    drawn = _Beams.of(Drawn.of(Readings(readings), headings, how.resolution_m), how)
    keys = np.rint(drawn.bearings_rad * (_DIRECTIONS / (2 * np.pi))).astype(np.int64) % _DIRECTIONS
    chains = _Chains.of(drawn, keys)
    if chains.differ.any():
        _, exact = np.unique(drawn.steps, axis=0, return_inverse=True)
        # Groups without a common chain are parted by their exact steps; adding all directions keeps the keys apart from
        # the rest.
        differ = chains.differ[chains.group_of]
        keys[differ] = exact.reshape(-1)[differ] + _DIRECTIONS
        chains = _Chains.of(drawn, keys)
    return _listed(drawn, chains, headings.shape[1])


@dataclass(frozen=True, slots=True, eq=False)
class _Beams:
    """Beams one by one, reading after reading, for each all headings."""

    bearings_rad: NDArray[np.float64]
    steps: NDArray[np.float64]
    lengths: Ints
    """Cells of the body, with the robot's own where it starts elsewhere."""
    starts: Ints
    """``int64[n, 2]``."""
    heads: NDArray[np.int32]
    """``int32[n, 2]``."""

    @classmethod
    def of(cls, drawn: Drawn, how: BeamSettings) -> "_Beams":
        starts, heads = drawn.start_cells, drawn.head_cells
        heads[drawn.is_miss] = NO_HEAD
        lengths = drawn.body_lengths(how.error_radius_cells, how.reach_cells) + starts.any(axis=1)
        return cls(drawn.bearings_rad, drawn.steps, lengths, starts, heads.astype(np.int32))


@dataclass(frozen=True, slots=True, eq=False)
class _Chains:
    """Beams in groups, and the chain of each."""

    group_of: Ints
    """``int64[beams]``."""
    cells: NDArray[np.int32]
    """``int32[n, 2]``."""
    ends: Ints
    """``int64[groups + 1]``: where each chain begins, and the end of the last."""
    differ: NDArray[np.bool_]
    """``bool[groups]``: the beams of this group have no chain in common."""

    @classmethod
    def of(cls, drawn: _Beams, keys: Ints) -> "_Chains":
        """Put beams of equal keys and starts together."""
        named = np.column_stack((keys, drawn.starts))
        _, first, group_of = np.unique(named, axis=0, return_index=True, return_inverse=True)
        group_of = group_of.reshape(-1).astype(np.int64)
        sizes = np.zeros(len(first), np.int64)
        np.maximum.at(sizes, group_of, drawn.lengths)
        low, high = np.full((len(first), 2), np.inf), np.full((len(first), 2), -np.inf)
        np.minimum.at(low, group_of, drawn.steps)
        np.maximum.at(high, group_of, drawn.steps)
        least, greatest = (_cells(drawn.starts[first], steps, sizes) for steps in (low, high))
        ends = np.append(0, np.cumsum(sizes))
        differ = np.add.reduceat((least != greatest).any(axis=1), ends[:-1]) > 0
        return cls(group_of, least, ends, differ)


def _cells(starts: Ints, steps: NDArray[np.float64], sizes: Ints) -> NDArray[np.int32]:
    """Return the cells of chains one after the other; one that starts elsewhere has the robot's own cell before."""
    lead = starts.any(axis=1)
    k = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes + lead, sizes)
    cells = np.floor(0.5 + k[:, None] * np.repeat(steps, sizes, axis=0)) + np.repeat(starts, sizes, axis=0)
    cells[k < 0] = 0.0
    return np.ascontiguousarray(cells, np.int32)


def _listed(drawn: _Beams, chains: _Chains, headings: int) -> Beams:
    """Give every end of a body a slot, put chains into batches, and list the beams by batch and heading."""
    end_of = chains.ends[chains.group_of] + drawn.lengths - 1
    is_end = np.zeros(len(chains.cells), np.bool_)
    is_end[end_of] = True
    wanted = np.add.reduceat(is_end, chains.ends[:-1], dtype=np.int64)
    slots = max(SLOTS, int(wanted.max()))
    before = np.cumsum(wanted) - wanted
    batches = [0]
    while (left := int(np.searchsorted(before + wanted, before[batches[-1]] + slots, side="right"))) < len(wanted):
        batches.append(left)
    batch_of = np.repeat(np.arange(len(batches)), np.diff([*batches, len(wanted)]))
    taken = np.cumsum(is_end) - 1 - np.repeat(before[batches][batch_of], np.diff(chains.ends))
    slot_of = np.where(is_end, taken, -1)
    lists = batch_of[chains.group_of] * headings + np.arange(len(end_of)) % headings
    order = np.argsort(lists, kind="stable")
    bounds = np.searchsorted(lists[order], np.arange(len(batches) * headings + 1))
    beams = np.column_stack((slot_of[end_of], drawn.heads))[order]
    parts = (np.column_stack((chains.cells, slot_of)), chains.ends, beams, np.array([*batches, len(wanted)]), bounds)
    counts = BeamCounts(len(chains.cells), len(wanted), len(beams), len(batches), headings, slots)
    return Beams(np.concatenate([part.reshape(-1) for part in parts], dtype=np.int32, casting="unsafe"), counts)
