"""The example programs of the documentation, as processes of their own beside a daemon on a simulated robot."""

import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from robotd.cli.demo.rig import rig, wired
from robotd.client import Client
from robotd.config import Config
from robotd.contract.missions import MapStart
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.sim.buildings.world import load_world

pytestmark = [pytest.mark.slow, pytest.mark.real_clock, pytest.mark.shares_descriptors]

DOCS = Path(__file__).parents[2] / "docs"
READINGS = 150
PATIENCE_S = 180.0
WHERE = r"localized at x (0\.9|1\.0)\d\d m, y (1\.0|1\.1)\d\d m, \d+ of \d+ readings explained"


@pytest.fixture(scope="module")
def runtime_dir(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Where a daemon serves that has made a map of the office from one stop, where its robot still stands."""
    directory = tmp_path_factory.mktemp("rig")
    config = Config(sweep=SweepSettings(readings=READINGS))
    with rig(directory, wired(config, directory), ["sim", "office"]) as parts:
        parts.client.arm()
        for _ in parts.client.run_mission(MapStart.of("office", (), load_world("office").start_pose), lease_s=5.0):
            pass
        parts.client.disarm()
        yield directory / "run"


def run(runtime_dir: Path, *arguments: str) -> str:
    """Run a program of somebody else's, who knows nothing but where the sockets are."""
    done = subprocess.run(
        [sys.executable, *arguments],
        check=False,
        env={**os.environ, "ROBOTD_RUNTIME_DIR": str(runtime_dir)},
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_example_client_hears_poses_while_it_waits_for_its_answer(runtime_dir: Path) -> None:
    said = run(runtime_dir, str(DOCS / "example_client.py")).splitlines()
    published = [line for line in said if line.startswith("published: ")]
    ranks = [int(line.split(" of ")[1].split()[0]) for line in published if " of " in line]
    assert len(set(ranks)) >= 5, "estimates come while the sweep is under way, from ever more readings"
    assert re.fullmatch(f"answer: {WHERE}", said[-1]), said[-1]


def test_the_example_client_has_about_thirty_lines() -> None:
    assert len((DOCS / "example_client.py").read_text(encoding="utf-8").splitlines()) <= 40


def test_the_python_on_the_page_of_the_api_works_as_it_stands(runtime_dir: Path) -> None:
    (program,) = re.findall(r"```python\n(.*?)```", (DOCS / "api.md").read_text(encoding="utf-8"), re.DOTALL)
    assert "localized at x" in run(runtime_dir, "-c", program)
    with Client(runtime_dir) as client:
        assert client.status().mode == "idle"


@pytest.mark.skipif(shutil.which("node") is None, reason="no Node.js here")
def test_the_client_in_javascript_asks_listens_and_stops_the_robot_when_it_is_interrupted(runtime_dir: Path) -> None:
    program = subprocess.Popen(
        ["node", str(DOCS / "examples" / "client.mjs"), str(runtime_dir)], stdout=subprocess.PIPE, text=True
    )
    assert program.stdout is not None
    with program, Client(runtime_dir) as client:
        assert program.stdout.readline() == f"mode {client.status().mode}: {client.status().reason}\n"
        # A new subscriber hears the newest pose at once.
        assert re.match(r"(localized|predicted): x \d\.\d+ m, y \d\.\d+ m", program.stdout.readline())
        program.send_signal(signal.SIGINT)
        program.communicate(timeout=PATIENCE_S)
        assert program.returncode == 0
        assert client.status().reason == "Ctrl-C in the example"
