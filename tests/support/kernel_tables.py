"""The tables of kernels that there are, for tests that hold one against the other."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from robotd.grid.kernels import AVAILABLE, Kernels, use
from robotd.grid.kernels.twins import TWINS

NATIVE = next((kernels for kernels in AVAILABLE if kernels.about.compiled), TWINS)
"""Those in C; where they were not compiled, their twins."""

both = pytest.mark.parametrize(
    "kernels", AVAILABLE, ids=["c" if kernels.about.compiled else "numpy" for kernels in AVAILABLE]
)
needs_native = pytest.mark.skipif(NATIVE is TWINS, reason="robotd was installed without a compiler")


@contextmanager
def using(kernels: Kernels) -> Iterator[None]:
    """Let these compute for a while."""
    before = use(kernels)
    try:
        yield
    finally:
        use(before)
