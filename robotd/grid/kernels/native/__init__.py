"""The kernels in C. Importing this fails where they were not compiled; each call releases the GIL.

Every function has a twin of the same name and the same results in :mod:`robotd.grid.kernels.twins`, where it is
described.
"""

from robotd.grid.kernels.native.casting import cast_beams, skip_codes, wall_codes
from robotd.grid.kernels.native.counting import (
    INSTRUCTION_SETS,
    at_least,
    count_feasible,
    greatest,
    instruction_set,
)
from robotd.grid.kernels.native.distances import squared_distances
from robotd.grid.kernels.native.drawing import draw_beams
from robotd.grid.kernels.native.erring import share_errors
from robotd.grid.kernels.native.fanning import count_fans
from robotd.grid.kernels.native.fitting import fit_poses, scan_poses
from robotd.grid.kernels.native.growing import grow_disk
from robotd.grid.kernels.native.inserting import insert_sweep
from robotd.grid.kernels.native.packing import pack_cells
from robotd.grid.kernels.native.searching import make_planes, renew_planes, search_poses
from robotd.grid.kernels.native.weighing import weigh_beams

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
