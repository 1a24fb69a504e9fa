"""The kernels' own tests once more, with the kernels under the sanitizers: nothing they do is left undefined by C.

A few cases of each property: all of them, and the tests of all that calls a kernel, are for ``make kernels-sanitized``.
"""

from pathlib import Path

import pytest

from tests.studies.sanitized.compiling import build, runtime
from tests.studies.sanitized.run import run_tests

CASES = 10
_ASKED = """
import numpy as np
from robotd.grid.kernels._native import ffi, lib

def test_past_the_end():
    lib.greatest(ffi.from_buffer("uint64_t[]", np.zeros(8, np.uint64)), 4096, 8)
"""


@pytest.mark.slow
@pytest.mark.timeout(400)
def test_the_kernels_tests_pass_under_sanitizers_that_catch_one_that_reads_past_the_end(tmp_path: Path) -> None:
    if runtime() is None:
        pytest.skip("there is no C compiler with sanitizers")
    module = build(tmp_path)
    done = run_tests(module, "tests/unit/grid/kernels", "-k", "not [numpy]", cases=CASES)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    assert " passed" in done.stdout

    (tmp_path / "test_asked.py").write_text(_ASKED)
    caught = run_tests(module, str(tmp_path), "--rootdir", str(tmp_path))
    assert caught.returncode != 0
    assert "AddressSanitizer: heap-buffer-overflow" in caught.stderr
