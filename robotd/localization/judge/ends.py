"""Where the readings of a sweep end, seen from a place: on the map, where nobody has looked, or against the map."""

import numpy as np
from numpy.typing import NDArray

from robotd.contract.estimate import Ends
from robotd.grid.kernels.weigh.weigh_kernel import AS_MAPPED, IN_UNKNOWN
from robotd.localization.judge.climbing import Hill


def ends_at(hill: Hill, pose: NDArray[np.float64]) -> Ends:
    """Return what share of what readings say ends where, at a pose ``float64[3]``. O(readings).

    A reading is shared among the ways in which it may have come about, by how likely each is; what would mean nothing
    on any map is against this one.
    """
    densities = hill.likelihood.densities(hill.sight, pose[None])[0]
    meant = (1.0 - hill.likelihood.model.outlier_share) * densities
    shares = meant / (meant.sum(axis=1) + hill.sight.meaningless)[:, None]
    as_mapped, in_unknown = (
        float(hill.weights @ shares[:, way] / hill.weights.sum()) for way in (AS_MAPPED, IN_UNKNOWN)
    )
    return Ends(as_mapped, in_unknown, max(0.0, 1.0 - as_mapped - in_unknown))
