"""The kernels in C. Importing this fails where they were not compiled; each call releases the GIL.

Every one gives the results of its twin, bit for bit.
"""

from robotd.grid.kernels.cast import cast_native
from robotd.grid.kernels.count import count_native
from robotd.grid.kernels.distance import distance_native
from robotd.grid.kernels.draw import draw_native
from robotd.grid.kernels.error_radius import error_radius_native
from robotd.grid.kernels.fans import fans_native
from robotd.grid.kernels.fit import fit_native
from robotd.grid.kernels.grow import grow_native
from robotd.grid.kernels.insert import insert_native
from robotd.grid.kernels.pack import pack_native
from robotd.grid.kernels.search import search_native
from robotd.grid.kernels.shared.library import instruction_set
from robotd.grid.kernels.table import Kernels, KernelsInUse
from robotd.grid.kernels.weigh import weigh_native

NATIVE = Kernels(
    about=KernelsInUse(compiled=True, instructions=instruction_set(), reason="compiled when robotd was installed"),
    cast=cast_native,
    count=count_native,
    distance=distance_native,
    draw=draw_native,
    error_radius=error_radius_native,
    fans=fans_native,
    fit=fit_native,
    grow=grow_native,
    insert=insert_native,
    pack=pack_native,
    search=search_native,
    weigh=weigh_native,
)
