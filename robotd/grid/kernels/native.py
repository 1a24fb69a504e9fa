"""The kernels in C. Importing this fails where they were not compiled; each call releases the GIL.

Every function has a twin of the same name and the same results in :mod:`robotd.grid.kernels.twins`, where it is
described.
"""

from robotd.grid.kernels.cast.cast_native import cast_beams, skip_codes, wall_codes
from robotd.grid.kernels.count.count_native import (
    INSTRUCTION_SETS,
    at_least,
    count_feasible,
    greatest,
    instruction_set,
)
from robotd.grid.kernels.distance.distance_native import squared_distances
from robotd.grid.kernels.draw.draw_native import draw_beams
from robotd.grid.kernels.error_radius.error_radius_native import share_errors
from robotd.grid.kernels.fans.fans_native import count_fans
from robotd.grid.kernels.fit.fit_native import fit_poses, scan_poses
from robotd.grid.kernels.grow.grow_native import grow_disk
from robotd.grid.kernels.insert.insert_native import insert_sweep
from robotd.grid.kernels.pack.pack_native import pack_cells
from robotd.grid.kernels.search.search_native import make_planes, renew_planes, search_poses
from robotd.grid.kernels.weigh.weigh_native import weigh_beams

__all__ = [
    "INSTRUCTION_SETS",
    "at_least",
    "cast_beams",
    "count_fans",
    "count_feasible",
    "draw_beams",
    "fit_poses",
    "greatest",
    "grow_disk",
    "insert_sweep",
    "instruction_set",
    "make_planes",
    "pack_cells",
    "renew_planes",
    "scan_poses",
    "search_poses",
    "share_errors",
    "skip_codes",
    "squared_distances",
    "wall_codes",
    "weigh_beams",
]
