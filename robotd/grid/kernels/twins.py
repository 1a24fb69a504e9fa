"""The kernels in NumPy: what the ones in C must do, and what does it where they were not compiled."""

from robotd.grid.kernels.cast.cast_twin import cast_beams, skip_codes, wall_codes
from robotd.grid.kernels.count.count_twin import at_least, count_feasible, greatest
from robotd.grid.kernels.distance.distance_twin import squared_distances
from robotd.grid.kernels.draw.draw_twin import draw_beams
from robotd.grid.kernels.error_radius.error_radius_twin import share_errors
from robotd.grid.kernels.fans.fans_twin import count_fans
from robotd.grid.kernels.fit.fit_twin import fit_poses, scan_poses
from robotd.grid.kernels.grow.grow_twin import grow_disk
from robotd.grid.kernels.insert.insert_twin import insert_sweep
from robotd.grid.kernels.pack.pack_twin import pack_cells
from robotd.grid.kernels.search.search_twin import make_planes, renew_planes, search_poses
from robotd.grid.kernels.weigh.weigh_twin import weigh_beams

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
