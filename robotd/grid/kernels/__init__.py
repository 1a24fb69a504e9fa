"""The hot loops: in C where they were compiled, else in NumPy, with identical results.

The only place that chooses. Everybody else imports the functions from here; tests also compare
:mod:`~robotd.grid.kernels.native` with :mod:`~robotd.grid.kernels.twins` directly.
"""

from dataclasses import dataclass

from robotd.grid.kernels import twins


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


try:
    from robotd.grid.kernels import native
except ImportError as error:
    IN_USE = KernelsInUse(compiled=False, instructions="numpy", reason=f"no C kernels were installed ({error})")
    draw_beams, count_feasible = twins.draw_beams, twins.count_feasible
    greatest, at_least, insert_sweep = twins.greatest, twins.at_least, twins.insert_sweep
    squared_distances, grow_disk, pack_cells = twins.squared_distances, twins.grow_disk, twins.pack_cells
    wall_codes, skip_codes, weigh_beams = twins.wall_codes, twins.skip_codes, twins.weigh_beams
    make_planes, renew_planes, search_poses = twins.make_planes, twins.renew_planes, twins.search_poses
    fit_poses, scan_poses, cast_beams = twins.fit_poses, twins.scan_poses, twins.cast_beams
    count_fans, share_errors = twins.count_fans, twins.share_errors
else:
    IN_USE = KernelsInUse(
        compiled=True, instructions=native.instruction_set(), reason="compiled when robotd was installed"
    )
    draw_beams, count_feasible = native.draw_beams, native.count_feasible
    greatest, at_least, insert_sweep = native.greatest, native.at_least, native.insert_sweep
    squared_distances, grow_disk, pack_cells = native.squared_distances, native.grow_disk, native.pack_cells
    wall_codes, skip_codes, weigh_beams = native.wall_codes, native.skip_codes, native.weigh_beams
    make_planes, renew_planes, search_poses = native.make_planes, native.renew_planes, native.search_poses
    fit_poses, scan_poses, cast_beams = native.fit_poses, native.scan_poses, native.cast_beams
    count_fans, share_errors = native.count_fans, native.share_errors

__all__ = [
    "IN_USE",
    "KernelsInUse",
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
