"""What a program loads that it does not need: a daemon nothing of people's, a client nothing of the engine's.

How long a command of robotctl takes to begin is told by how many modules it loads, on a busy machine, too: two of them
take about a millisecond.
"""

import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

import pytest

ROOMS_OF_OTHERS = {"robotd.sim", "robotd.cli"}
LIBRARIES_OF_OTHERS = {"rich", "matplotlib", "PIL", "scipy", "hypothesis", "pytest"}
LARGEST_MIB = 60.0
COMPUTES = (
    "robotd.grid.kernels",
    "robotd.grid.occupancy",
    "robotd.localization.ready_map",
    "robotd.planning.path",
    "robotd.head.desk",
    "robotd.head.program",
)
"""All else that computes stands on these."""
ROOMS_OF_CLIENTS = {"client", "contract", "core"}
ROOMS_OF_FRONT = {"front", "server", "children", "contract", "core"}
LIBRARIES_OF_THE_ENGINE = {"cffi", "_cffi_backend", "serial", "mcap", "rich", "firmware_proto"}
LARGEST_CLIENT_MIB = 45.0

MODULES_AT_MOST = {
    "status": 420,
    "map list": 430,
    "map compare a b --maps none": 590,
    "map import none.yaml": 430,
    "config show none.toml": 410,
    "doctor": 520,
    "calibrate --help": 490,
    "sim --help": 400,
    "fake none.mcap": 410,
    "demo --help": 340,
    "replay none.mcap": 420,
    "export tum none.mcap out": 460,
    "report none.mcap out.html": 410,
    "eval --help": 460,
    "exact none.toml none.csv": 570,
}
"""What robotctl loads until it has answered: with NumPy and rich, 131 modules, 300 ms are about 550."""
COUNTED = """
import io, os, sys
if len(sys.argv) > 2:
    import numpy, rich.console  # nearly all need them: once for all
from robotd.cli.main import main
for line in sys.argv[1:]:
    if not os.fork():
        sys.stdout = sys.stderr = io.StringIO()
        try:
            main(line.split())
        except SystemExit:
            pass
        os.write(1, f"{len(sys.modules)},{line}\\n".encode())
        os._exit(0)
    os.wait()
"""


def tell(program: str) -> list[str]:
    """Return the words that a fresh interpreter prints."""
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout.split()


@pytest.fixture(scope="module")
def modules() -> set[str]:
    return set(tell("import robotd.app.daemon, sys; print(*sys.modules)"))


def test_the_daemon_imports_no_room_of_others(modules: set[str]) -> None:
    assert "robotd.mission.supervisor" in modules
    assert {name for name in modules if ".".join(name.split(".")[:2]) in ROOMS_OF_OTHERS} == set()


def test_the_heart_imports_nothing_that_serves_strangers(modules: set[str]) -> None:
    assert {name.split(".")[0] for name in modules} & {"zmq"} == set()
    assert {name for name in modules if name.startswith(("robotd.server.", "robotd.client"))} == {
        "robotd.server.settings"
    }


def test_the_heart_imports_nothing_that_computes(modules: set[str]) -> None:
    assert "robotd.head.far" in modules
    assert {name for name in modules if name.startswith(COMPUTES)} == set()


def test_the_daemon_imports_no_library_that_only_people_need(modules: set[str]) -> None:
    assert {name.split(".")[0] for name in modules} & LIBRARIES_OF_OTHERS == set()


def test_the_daemon_is_small_before_it_remembers_anything() -> None:
    pages = tell("import robotd.app.daemon; print(open('/proc/self/statm').read())")[1]
    assert int(pages) * 4096 / 2**20 < LARGEST_MIB


def test_the_gateway_loads_nothing_of_the_engine_and_robotctl_no_web_server() -> None:
    gateway = set(tell("import robotd.gateway.composed, sys; print(*sys.modules)"))
    assert "aiohttp" in gateway
    assert {name.split(".")[1] for name in gateway if name.startswith("robotd.")} == {
        *ROOMS_OF_CLIENTS,
        "gateway",
    }
    assert {name.split(".")[0] for name in gateway} & LIBRARIES_OF_THE_ENGINE == set()
    command_line = set(tell("import robotd.cli.main, robotd.cli.verbs.gateway, sys; print(*sys.modules)"))
    assert {name.split(".")[0] for name in command_line} & {"aiohttp", "prometheus_client"} == set()


@pytest.mark.parametrize(
    ("module", "rooms"),
    [
        ("robotd.client.async_client, robotd.client.sync_client", ROOMS_OF_CLIENTS),
        ("robotd.front.program", ROOMS_OF_FRONT),
    ],
)
def test_clients_and_the_server_load_nothing_of_the_engine(module: str, rooms: set[str]) -> None:
    """No grid, maps, hardware, localization, kernels; and it says what the import costs (``pytest -s``)."""
    loaded = tell(
        "import time; begun = time.perf_counter()\n"
        f"import {module}, sys; took = time.perf_counter() - begun\n"
        "print(took, open('/proc/self/statm').read().split()[1], *sys.modules)"
    )
    took_s, mib, modules = float(loaded[0]), int(loaded[1]) * 4096 / 2**20, set(loaded[2:])
    ours = {name for name in modules if name.startswith("robotd.")}
    print(f"import {module}: {len(ours)} modules of robotd, {1000 * took_s:.0f} ms, {mib:.0f} MiB")
    assert {name.split(".")[1] for name in ours} == rooms
    assert {name.split(".")[0] for name in modules} & LIBRARIES_OF_THE_ENGINE == set()
    assert mib < LARGEST_CLIENT_MIB


def counted(directory: Path, lines: Iterable[str]) -> dict[str, int]:
    """Return how many modules are loaded when robotctl has carried out each of some command lines."""
    asked = [sys.executable, "-c", COUNTED, *lines]
    said = subprocess.run(asked, capture_output=True, text=True, check=True, cwd=directory).stdout
    return {line: int(count) for count, line in (told.split(",") for told in said.splitlines())}


def test_a_verb_that_needs_no_daemon_or_finds_none_answers_at_once(tmp_path: Path) -> None:
    found = counted(tmp_path, MODULES_AT_MOST)
    assert found.keys() == MODULES_AT_MOST.keys()
    assert {line: count for line, count in found.items() if count > MODULES_AT_MOST[line]} == {}
    assert counted(tmp_path, ["--help"])["--help"] < 120
