"""The daemon carries nothing that only people, simulations or pictures need, and so it stays small."""

import subprocess
import sys

import pytest

ROOMS_OF_OTHERS = {"robotd.sim", "robotd.cli"}
LIBRARIES_OF_OTHERS = {"rich", "rich_argparse", "matplotlib", "PIL", "scipy", "hypothesis", "pytest"}
LARGEST_MIB = 60.0


def tell(program: str) -> list[str]:
    """Return the words that a fresh interpreter prints."""
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout.split()


@pytest.fixture(scope="module")
def modules() -> set[str]:
    return set(tell("import robotd.app.daemon, sys; print(*sys.modules)"))


def test_the_daemon_imports_no_room_of_others(modules: set[str]) -> None:
    assert "robotd.server.server" in modules
    assert {name for name in modules if ".".join(name.split(".")[:2]) in ROOMS_OF_OTHERS} == set()


def test_the_daemon_imports_no_library_that_only_people_need(modules: set[str]) -> None:
    assert {name.split(".")[0] for name in modules} & LIBRARIES_OF_OTHERS == set()


def test_the_daemon_is_small_before_it_remembers_anything() -> None:
    pages = tell("import robotd.app.daemon; print(open('/proc/self/statm').read())")[1]
    assert int(pages) * 4096 / 2**20 < LARGEST_MIB
