"""The kernels in NumPy: what the ones in C must do, and what does it where they were not compiled."""

from robotd.grid.kernels.cast import cast_twin
from robotd.grid.kernels.count import count_twin
from robotd.grid.kernels.distance import distance_twin
from robotd.grid.kernels.draw import draw_twin
from robotd.grid.kernels.error_radius import error_radius_twin
from robotd.grid.kernels.fans import fans_twin
from robotd.grid.kernels.fit import fit_twin
from robotd.grid.kernels.grow import grow_twin
from robotd.grid.kernels.insert import insert_twin
from robotd.grid.kernels.pack import pack_twin
from robotd.grid.kernels.search import search_twin
from robotd.grid.kernels.table import Kernels, KernelsInUse
from robotd.grid.kernels.weigh import weigh_twin

TWINS = Kernels(
    about=KernelsInUse(compiled=False, instructions="numpy", reason="no C kernels were installed"),
    cast=cast_twin,
    count=count_twin,
    distance=distance_twin,
    draw=draw_twin,
    error_radius=error_radius_twin,
    fans=fans_twin,
    fit=fit_twin,
    grow=grow_twin,
    insert=insert_twin,
    pack=pack_twin,
    search=search_twin,
    weigh=weigh_twin,
)
