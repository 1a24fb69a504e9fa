"""The kernels' own tests once more, with the kernels under the sanitizers: nothing they do is left undefined by C."""

from pathlib import Path

import pytest

from tests.studies.sanitized.compiling import build, runtime
from tests.studies.sanitized.run import run_tests

needs_sanitizers = pytest.mark.skipif(runtime() is None, reason="there is no C compiler with sanitizers")


@pytest.fixture(scope="module")
def module(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The kernels, compiled."""
    return build(tmp_path_factory.mktemp("sanitized"))


@needs_sanitizers
@pytest.mark.slow
@pytest.mark.timeout(400)
def test_the_kernels_tests_pass_under_the_sanitizers(module: Path) -> None:
    done = run_tests(module, "tests/unit/grid/kernels", "-k", "not [numpy]")
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    assert " passed" in done.stdout


_ASKED = """
import numpy as np
from robotd.grid.kernels._native import ffi, lib

def test_past_the_end():
    lib.greatest(ffi.from_buffer("uint64_t[]", np.zeros(8, np.uint64)), 4096, 8)
"""


@needs_sanitizers
def test_a_kernel_that_reads_past_the_end_is_caught(module: Path, tmp_path: Path) -> None:
    """Else the test above would show nothing."""
    (tmp_path / "test_asked.py").write_text(_ASKED)
    done = run_tests(module, str(tmp_path), "--rootdir", str(tmp_path))
    assert done.returncode != 0
    assert "AddressSanitizer: heap-buffer-overflow" in done.stderr
