"""Fitting poses to walls, in C."""

import numpy as np
from numpy.typing import NDArray

from robotd.grid.kernels._native import ffi, lib
from robotd.grid.kernels.fitting import Fits
from robotd.grid.kernels.native.buffers import floats


def fit_poses(
    codes: NDArray[np.int8],
    distances: NDArray[np.float64],
    heads: NDArray[np.float64],
    boxes: NDArray[np.float64],
    outlier_cells: float,
) -> Fits:
    """See the twin."""
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
