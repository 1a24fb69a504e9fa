"""The table of kernels: what each must do, no matter in which language.

A row stands for a shelf. It is filled by a module of that shelf, in C or in NumPy, or by anything else that gives the
same answers: a processor of another kind needs only the rows that it does better,
``dataclasses.replace(NATIVE, count=...)``.
"""

from dataclasses import dataclass

from robotd.grid.kernels.cast.cast_kernel import CastKernel
from robotd.grid.kernels.count.count_kernel import CountKernel
from robotd.grid.kernels.distance.distance_kernel import DistanceKernel
from robotd.grid.kernels.draw.draw_kernel import DrawKernel
from robotd.grid.kernels.error_radius.error_radius_kernel import ErrorRadiusKernel
from robotd.grid.kernels.fans.fans_kernel import FansKernel
from robotd.grid.kernels.fit.fit_kernel import FitKernel
from robotd.grid.kernels.grow.grow_kernel import GrowKernel
from robotd.grid.kernels.insert.insert_kernel import InsertKernel
from robotd.grid.kernels.pack.pack_kernel import PackKernel
from robotd.grid.kernels.search.search_kernel import SearchKernel
from robotd.grid.kernels.weigh.weigh_kernel import WeighKernel


@dataclass(frozen=True, slots=True)
class KernelsInUse:
    """Which kernels these are, for logs and for people."""

    compiled: bool
    instructions: str
    """What the counting uses: ``avx512``, ``avx2``, ``portable`` or, where nothing was compiled, ``numpy``."""
    reason: str
    """Why these."""

    def __str__(self) -> str:
        """Return one line."""
        return f"{'C' if self.compiled else 'NumPy'} kernels ({self.instructions}): {self.reason}"


@dataclass(frozen=True, slots=True)
class Kernels:
    """One of each."""

    about: KernelsInUse
    cast: CastKernel
    count: CountKernel
    distance: DistanceKernel
    draw: DrawKernel
    error_radius: ErrorRadiusKernel
    fans: FansKernel
    fit: FitKernel
    grow: GrowKernel
    insert: InsertKernel
    pack: PackKernel
    search: SearchKernel
    weigh: WeighKernel
