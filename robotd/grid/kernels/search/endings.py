"""Where bodies end, seen from their heads: the sectors that the planes of the search tell apart."""

import functools

import numpy as np
from numpy.typing import NDArray

from robotd.grid.ray import ray_steps

RING = 16
"""Offsets of a body's end from its head are tabulated so far."""
_REACH = 8
"""Bodies that end so near to their head are told apart by where they end. As in planes_layout.h."""
_SECTORS = 8


@functools.lru_cache(maxsize=8)
def endings(error_radius_cells: float, cells: int) -> NDArray[np.int8]:
    """Return the sector of every offset at which bodies end from their heads, ``int8[33, 33]``, 0 where none does.

    Found by drawing beams: an ending that was overlooked costs time and changes nothing.

    Args:
        error_radius_cells: by how much bodies are shorter.
        cells: how many of the last cells of a body are meant.
    """
    # Half a degree and a twentieth of a cell apart: what falls between costs time, not answers.
    bearings_rad = np.repeat(np.arange(720) * (np.pi / 360), 40)
    lengths = (error_radius_cells + 8.0 + np.tile(np.arange(40) / 20, 720))[:, None]
    steps = ray_steps(bearings_rad)
    ahead = np.stack((np.sin(bearings_rad), np.cos(bearings_rad)), axis=1)
    counts = np.ceil((lengths - error_radius_cells) * np.abs(ahead).max(axis=1, keepdims=True))
    sectors = np.zeros((2 * RING + 1, 2 * RING + 1), np.int8)
    for back in range(1, cells + 1):
        offsets = (np.floor(0.5 + (counts - back) * steps) - np.floor(0.5 + lengths * ahead)).astype(np.intp)
        row, col = offsets[(np.abs(offsets) <= _REACH).all(axis=1)].T
        turns = np.arctan2(row, col) / (2 * np.pi)
        sectors[row + RING, col + RING] = 1 + np.floor(turns % 1.0 * _SECTORS) % _SECTORS
    return sectors
