"""How the C kernels are compiled: cffi in API mode, limited ABI. Read by setup.py, never imported by the program."""

from pathlib import Path

from cffi import FFI

HERE = Path(__file__).parent
KERNELS = (
    "cast",
    "count",
    "distance",
    "draw",
    "errors",
    "fan",
    "fit",
    "grow",
    "insert",
    "pack",
    "planes",
    "search",
    "weigh",
)
"""Each a source and the header that declares what Python calls."""

builder = FFI()
builder.cdef("".join((HERE / f"{name}.h").read_text() for name in KERNELS))
builder.set_source(
    "robotd.grid.kernels._native",
    "#include <stdint.h>\n" + "".join(f'#include "{name}.h"\n' for name in KERNELS),
    sources=[f"robotd/grid/kernels/c/{name}.c" for name in KERNELS],
    include_dirs=["robotd/grid/kernels/c"],
    depends=sorted(f"robotd/grid/kernels/c/{header.name}" for header in HERE.glob("*.h")),
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
    py_limited_api=True,
)
