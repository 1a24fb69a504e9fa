"""Many readings at many headings, drawn at once, those in one direction together: what the kernels count.

Each beam has exactly the cells that :func:`robotd.localization.probe.probe_of` gives it. Readings and headings that
are multiples of one step share their directions: 300 x 300 beams run along 300 chains of cells. Directions count as one
only if that is proved: a coordinate of a chain's cell is ``floor(0.5 + k * step)``, which never falls as the step
grows, so a chain that is the same for the smallest and for the greatest step of a group is the same for all of it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robotd.core.reading import RangeReading, ReadingStatus
from robotd.grid.kernels.layout import NO_HEAD, BeamGroups
from robotd.grid.ray import ray_steps

_DIRECTION_BITS = 30
"""Directions nearer than this share of a turn are tried as one."""
_LENGTH_BITS = 16
_FAR_CELLS = float(1 << 28)
"""A head further away than this is as far outside every grid as one at this distance."""


def draw_beams(
    readings: Sequence[RangeReading],
    headings_rad: NDArray[np.float64],
    *,
    resolution_m: float,
    error_radius_cells: float,
    reach_cells: int,
) -> BeamGroups:
    """Draw measured readings, one beam for each and every heading; else as :func:`probe_of`.

    Raises:
        ValueError: a reading measured nothing.
    """
    drawn = _Drawn.of(readings, headings_rad, resolution_m, error_radius_cells, reach_cells)
    directions = np.rint(drawn.bearings_rad * ((1 << _DIRECTION_BITS) / (2 * np.pi))).astype(np.int64)
    directions &= (1 << _DIRECTION_BITS) - 1
    groups, split = _grouped(drawn, directions)
    if split.any():
        exact, _ = _numbered(drawn.steps[split])
        directions[split] = exact + (1 << _DIRECTION_BITS)
        groups, _ = _grouped(drawn, directions)
    return groups


@dataclass(frozen=True, slots=True, eq=False)
class _Drawn:
    """Beams one by one, reading after reading, for each all headings."""

    headings: int
    bearings_rad: NDArray[np.float64]
    steps: NDArray[np.float64]
    """``float64[n, 2]``, as :func:`ray_steps`."""
    lengths: NDArray[np.int64]
    """Cells of the ray, without the robot's own where the ray starts elsewhere."""
    starts: NDArray[np.int64]
    """``int64[n, 2]``."""
    heads: NDArray[np.int32]
    """``int32[n, 2]``."""

    @classmethod
    def of(
        cls,
        readings: Sequence[RangeReading],
        headings_rad: NDArray[np.float64],
        resolution_m: float,
        error_radius_cells: float,
        reach_cells: int,
    ) -> "_Drawn":
        values = np.array([_numbers(reading) for reading in readings], np.float64).reshape(-1, 5)
        bearing_rad, range_m, x_m, y_m, is_miss = values[:, :, None].transpose(1, 0, 2)
        sin, cos = np.sin(headings_rad), np.cos(headings_rad)
        start_row, start_col = (sin * x_m + cos * y_m) / resolution_m, (cos * x_m - sin * y_m) / resolution_m
        bearings_rad = (headings_rad + bearing_rad).ravel()
        ahead = np.stack((np.sin(bearings_rad), np.cos(bearings_rad)), axis=1)
        range_cells = range_m / resolution_m
        length_cells = np.repeat(np.clip(range_cells - error_radius_cells, 0.0, reach_cells), len(headings_rad))
        positions = np.stack((start_row.ravel(), start_col.ravel()), axis=1)
        tips = positions + np.repeat(range_cells, len(headings_rad))[:, None] * ahead
        heads = np.floor(np.clip(tips, -_FAR_CELLS, _FAR_CELLS) + 0.5).astype(np.int32)
        heads[np.repeat(is_miss > 0.0, len(headings_rad)), 0] = NO_HEAD
        lengths = np.maximum(np.ceil(length_cells * np.abs(ahead).max(axis=1)), 1.0).astype(np.int64)
        starts = np.floor(np.clip(positions, -_FAR_CELLS, _FAR_CELLS) + 0.5).astype(np.int64)
        return cls(len(headings_rad), bearings_rad, ray_steps(bearings_rad), lengths, starts, heads)


def _numbers(reading: RangeReading) -> tuple[float, float, float, float, bool]:
    if reading.range_m is None:
        raise ValueError(f"a {reading.status} reading has no range")
    is_miss = reading.status is ReadingStatus.MISS
    return reading.bearing_rad, reading.range_m, reading.origin_x_m, reading.origin_y_m, is_miss


def _grouped(drawn: _Drawn, directions: NDArray[np.int64]) -> tuple[BeamGroups, NDArray[np.bool_]]:
    """Put beams of one start and direction together, by length; and mark those whose chains differ after all."""
    places, place_of = _numbered(drawn.starts) if drawn.starts.any() else (np.zeros(len(directions), np.int64), None)
    elsewhere = drawn.starts.any(axis=1)
    lengths = drawn.lengths + elsewhere
    chain_keys = places << (_DIRECTION_BITS + 1) | directions
    order = np.lexsort((lengths, chain_keys)) if place_of is not None else np.argsort(
        chain_keys << _LENGTH_BITS | lengths
    )
    keys = chain_keys[order]
    first = np.flatnonzero(np.diff(keys, prepend=-1))
    last = np.append(first[1:], len(keys)) - 1
    steps = drawn.steps[order]
    members = order[first]
    sizes = lengths[order[last]]
    low, high = (
        _chains(drawn.starts[members], elsewhere[members], ends, sizes)
        for ends in (np.minimum.reduceat(steps, first), np.maximum.reduceat(steps, first))
    )
    differs = np.add.reduceat((low != high).any(axis=1), np.cumsum(sizes) - sizes) > 0
    split = np.zeros(len(keys), np.bool_)
    split[order] = np.repeat(differs, last + 1 - first)
    beams = np.ascontiguousarray(np.column_stack((order % drawn.headings, lengths[order], drawn.heads[order])), np.int32)
    bounds = np.ascontiguousarray(np.column_stack((np.append(0, np.cumsum(sizes)), np.append(first, len(keys)))), np.int32)
    return BeamGroups(low, bounds, beams), split


def _chains(
    starts: NDArray[np.int64], elsewhere: NDArray[np.bool_], steps: NDArray[np.float64], sizes: NDArray[np.int64]
) -> NDArray[np.int32]:
    """Return the cells of chains one after the other; one that starts elsewhere has the robot's own cell before."""
    k = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes + elsewhere, sizes)
    cells = np.floor(0.5 + k[:, None] * np.repeat(steps, sizes, axis=0)) + np.repeat(starts, sizes, axis=0)
    cells[k < 0] = 0.0
    return np.ascontiguousarray(cells, np.int32)


def _numbered(rows: NDArray[np.float64] | NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.intp]]:
    """Return a number per row, equal for equal rows, and one row of each number."""
    _, first, numbers = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    return numbers.reshape(-1).astype(np.int64), first
