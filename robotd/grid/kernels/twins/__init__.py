"""The kernels in NumPy: what the ones in C must do, and what does it where they were not compiled."""

from robotd.grid.kernels.twins.casting import cast_beams, skip_codes, wall_codes
from robotd.grid.kernels.twins.counting import at_least, count_feasible, greatest
from robotd.grid.kernels.twins.distances import squared_distances
from robotd.grid.kernels.twins.drawing import draw_beams
from robotd.grid.kernels.twins.erring import share_errors
from robotd.grid.kernels.twins.fanning import count_fans
from robotd.grid.kernels.twins.fitting import fit_poses, scan_poses
from robotd.grid.kernels.twins.growing import grow_disk
from robotd.grid.kernels.twins.inserting import insert_sweep
from robotd.grid.kernels.twins.packing import pack_cells
from robotd.grid.kernels.twins.searching import make_planes, renew_planes, search_poses
from robotd.grid.kernels.twins.weighing import weigh_beams

__all__ = [
    "at_least",
    "cast_beams",
    "count_fans",
    "count_feasible",
    "draw_beams",
    "fit_poses",
    "greatest",
    "grow_disk",
    "insert_sweep",
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
