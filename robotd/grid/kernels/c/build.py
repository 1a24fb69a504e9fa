"""How the C kernels are compiled: cffi in API mode, limited ABI. Read by setup.py, never imported by the program."""

from pathlib import Path

from cffi import FFI

HERE = Path(__file__).parent
SOURCES = ("count.c", "draw.c", "insert.c")

builder = FFI()
builder.cdef((HERE / "kernels.h").read_text())
builder.set_source(
    "robotd.grid.kernels._native",
    '#include <stdint.h>\n#include "kernels.h"\n',
    sources=[f"robotd/grid/kernels/c/{name}" for name in SOURCES],
    include_dirs=["robotd/grid/kernels/c"],
    depends=[f"robotd/grid/kernels/c/{name}" for name in ("kernels.h", "count_body.h")],
    # Contraction would round differently from NumPy; no -march: a wheel must run elsewhere.
    extra_compile_args=["-std=gnu99", "-O3", "-ffp-contract=off", "-fvisibility=hidden", "-Wall", "-Wextra"],
    extra_link_args=["-pthread"],
    optional=True,
    py_limited_api=True,
)
