"""How the C kernels are compiled: cffi in API mode, limited ABI. Read by setup.py, never imported by the program.

A kernel is a shelf: what Python calls is declared in its headers of the name of a source, the rest is the sources' own.
"""

from pathlib import Path

from cffi import FFI

HERE = Path(__file__).parent
SHELF = "robotd/grid/kernels"
SOURCES = sorted(source.relative_to(HERE).as_posix() for source in HERE.glob("*/*.c"))
DECLARED = sorted(
    (f"{source.removesuffix('.c')}.h" for source in SOURCES if (HERE / source).with_suffix(".h").exists()),
    key=lambda header: (header != "search/planes.h", header),  # search.h knows what planes.h declares
)
"""The headers that Python reads."""

builder = FFI()
builder.cdef("".join((HERE / header).read_text() for header in DECLARED))
builder.set_source(
    "robotd.grid.kernels._native",
    "#include <stdint.h>\n" + "".join(f'#include "{header}"\n' for header in DECLARED),
    sources=[f"{SHELF}/{source}" for source in SOURCES],
    include_dirs=[SHELF],
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
    py_limited_api=True,
)
