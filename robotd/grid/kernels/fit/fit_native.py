"""Fitting poses to walls, in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels.cast.cast_kernel import FAR_CODE
from robotd.grid.kernels.fit.fit_kernel import (
    HEADS_MIN,
    LAGS,
    LEAST_SPREAD_CELLS,
    UNKNOWN_CELLS,
    UNKNOWN_RAD,
    Fits,
    Lattice,
)
from robotd.grid.kernels.shared.library import agree, ffi, floats, ints, lib

agree(HEADS_MIN=HEADS_MIN, LAGS=LAGS, LEAST_SPREAD_CELLS=LEAST_SPREAD_CELLS)
agree(UNKNOWN_CELLS=UNKNOWN_CELLS, UNKNOWN_RAD=UNKNOWN_RAD)


def fit_poses(
    codes: NDArray[np.int8],
    distances: NDArray[np.float64],
    heads: NDArray[np.float64],
    boxes: NDArray[np.float64],
    outlier_cells: float,
) -> Fits:
    """See :class:`.FitKernel`."""
    count, beams = len(boxes), len(heads)
    fits = Fits(np.empty((count, 3)), np.empty((count, 3, 3)), np.empty((count, 3)), np.empty((count, beams)))
    errors = np.empty(beams)
    job = ffi.new("fit_job *")
    job.codes, job.distances = ffi.from_buffer("int8_t[]", codes), floats(distances)
    job.rows, job.cols = codes.shape
    job.heads, job.head_count = floats(heads), beams
    job.boxes, job.box_count = floats(boxes), count
    job.outlier_cells = outlier_cells
    job.poses, job.covariances = floats(fits.poses), floats(fits.covariances)
    job.quality, job.beyond = floats(fits.quality), floats(fits.beyond)
    job.errors = floats(errors)
    lib.fit_poses(job)
    return fits


def scan_poses(
    codes: NDArray[np.int8], costs: NDArray[np.int32], heads: NDArray[np.float64], lattice: Lattice
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """See :class:`.FitKernel`."""
    least, turns = np.empty(lattice.shape, np.int32), np.empty(lattice.shape, np.int32)
    totals = np.empty(lattice.shape, np.int32)
    job = ffi.new("scan_job *")
    job.codes, job.costs = ffi.from_buffer("int8_t[]", codes), ints(costs)
    job.rows, job.cols = codes.shape
    job.far = int(costs[FAR_CODE + 128])
    job.heads, job.head_count = floats(heads), len(heads)
    job.start, job.steps = floats(lattice.start), ints(lattice.steps)
    job.step_cells, job.step_rad = lattice.step_cells, lattice.step_rad
    job.totals, job.least, job.turns = ints(totals), ints(least), ints(turns)
    lib.scan_poses(job)
    return least, turns
