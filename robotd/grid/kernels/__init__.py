"""The hot loops: in C where they were compiled, else in NumPy, with identical results.

Everybody asks :func:`in_use` for them when they compute; :func:`use` alone chooses.
"""

from dataclasses import dataclass, replace

from robotd.grid.kernels.table import Kernels, KernelsInUse
from robotd.grid.kernels.twins import TWINS


@dataclass(slots=True)
class _Choice:
    kernels: Kernels


_CHOICE = _Choice(TWINS)


def in_use() -> Kernels:
    """Return the kernels that compute."""
    return _CHOICE.kernels


def use(kernels: Kernels) -> Kernels:
    """Let these compute from now on, and return those that did before; what was begun ends with the old ones."""
    before, _CHOICE.kernels = _CHOICE.kernels, kernels
    return before


try:
    from robotd.grid.kernels.native import NATIVE
except ImportError as error:
    AVAILABLE: tuple[Kernels, ...] = (TWINS,)
    use(replace(TWINS, about=replace(TWINS.about, reason=f"{TWINS.about.reason} ({error})")))
else:
    AVAILABLE = (TWINS, NATIVE)
    use(NATIVE)

__all__ = ["AVAILABLE", "Kernels", "KernelsInUse", "in_use", "use"]
