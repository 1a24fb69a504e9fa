"""Programs made of the firmware's C, once for all tests; without a compiler these tests are skipped."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.studies.firmware.codec import build_codec
from tests.studies.firmware.compiling import compiler, run
from tests.studies.firmware.peer import build_peer

Program = Callable[[bytes], str]


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where programs are made."""
    if compiler() is None:
        pytest.skip("there is no C compiler")
    return tmp_path_factory.mktemp("firmware")


@pytest.fixture(scope="session")
def codec(built: Path) -> Program:
    """What a C receiver tells of a stream."""
    program = build_codec(built)
    return lambda stream: run(program, stream)


@pytest.fixture(scope="session")
def peer(built: Path) -> Path:
    """The program of a board on a scripted plant."""
    return build_peer(built)
