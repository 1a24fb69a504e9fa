"""How the C kernels are compiled: cffi in API mode, limited ABI. Read by setup.py, never imported by the program."""

import re
from pathlib import Path

from cffi import FFI

HERE = Path(__file__).parent
SHELF = "robotd/grid/kernels"
SOURCES = sorted(source.relative_to(HERE).as_posix() for source in HERE.glob("*/*.c"))
DECLARED = (
    "shared/shared.h",
    *(
        header
        for header in (f"{source.removesuffix('.c')}.h" for source in SOURCES if not source.startswith("shared/"))
        if (HERE / header).exists()
    ),
)
"""What Python calls: the header of each source, and before them what they share."""


def declarations(header: str) -> str:
    """Return a header without the preprocessor's lines, of which cffi knows nothing."""
    return re.sub(r"(?m)^#.*\n", "", (HERE / header).read_text())


builder = FFI()
builder.cdef("".join(map(declarations, DECLARED)))
builder.set_source(
    "robotd.grid.kernels._native",
    "".join(f'#include "{header}"\n' for header in DECLARED),
    sources=[f"{SHELF}/{source}" for source in SOURCES],
    include_dirs=[SHELF],
    # Else a header that changed would not compile its sources again.
    depends=sorted(f"{SHELF}/{header.relative_to(HERE).as_posix()}" for header in HERE.glob("*/*.h")),
    # Contraction would round differently from NumPy; no -march: a wheel must run elsewhere.
    extra_compile_args=[
        "-std=gnu99",
        "-O3",
        "-ffp-contract=off",
        "-fvisibility=hidden",
        "-Wall",
        "-Wextra",
        "-Wno-psabi",
    ],
    extra_link_args=["-pthread"],
    # One library for every later Python, not one for each.
    py_limited_api=True,
)
