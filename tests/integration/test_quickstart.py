"""The quick start does what it says: its own commands, in its own order, as processes on pseudo-terminals.

Every command of the page is executed as it stands there, but for what ``IN_THE_TEST`` says. One thing is
arranged between them: the configurations that ``robotctl sim`` writes get fewer readings and a brisker drive.
"""

import gzip
import json
import math
import os
import re
import shlex
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from robotd.client import Client
from robotd.contract.device_status import LinkState
from robotd.contract.events import Status
from robotd.contract.topics import Topic

pytestmark = [pytest.mark.slow, pytest.mark.real_clock, pytest.mark.timeout(600)]

ROOT = Path(__file__).parents[2]
BIN = Path(sys.executable).parent
IN_THE_TEST = {
    "make demo": "",  # a test of its own, below
    "source .venv/bin/activate": "",  # the tests run in such an environment already
    "robotctl map start office --world office": "robotctl map start office --world office --stop 2.1 1.7",  # of 5 stops
    "robotctl config check /etc/robotd/robotd.toml": f"robotctl config check {ROOT / 'systemd' / 'robotd.toml'}",
}
"""What the test types in the place of a command of the page."""
_PATIENCE_S = 180.0
"""With one command: a machine that is busy is slow."""
STAYS = ("robotctl sim", "robotctl fake", "robotd ")
"""Commands for a terminal of their own."""
FASTER = """
[sweep]
readings = 150
[driving]
speed_mps = 1.0
deceleration_mps2 = 0.8
turn_radps = 2.5
turn_deceleration_radps2 = 2.0
"""
SAYS = {
    "robotctl status": r"mode +disarmed(.|\n)*drive +ready(.|\n)*pantilt +ready(.|\n)*rangefinder +ready",
    "robotctl arm": r"^armed",
    "robotctl map save": r"saved office version \d+: 256 x 256 cells of 50 mm",
    "robotctl map show": r"█",
    "robotctl localize": r"localized: x (1\.9|2\.0)\d\d m, y (1\.5|1\.6)\d\d m",
    "robotctl pose": r"x (1\.9|2\.0)\d\d m, y (1\.5|1\.6)\d\d m",
    "robotctl record start": r"recording to .+\.mcap",
    "robotctl record stop": r"recorded .+\.mcap",
    "robotctl replay RECORDING": r"\d+ results in .* of recording: the same\ndigest \w+",
    "robotctl map show --json": r'"digest": "\w+"',
    "robotctl import carmen building.log.gz --out building.robotd": r"2 stops to map, 1 kept out",
}
"""What an answer must contain."""


def commands(page: Path) -> list[str]:
    """Return the commands of a page, in order: every line of its ``sh`` blocks."""
    blocks = re.findall(
        r"^( *)```(?:sh|console)\n(.*?)^\1```", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE
    )
    return [line.strip() for _, block in blocks for line in block.splitlines() if line.strip()]


def carmen_log() -> str:
    """Return the log of a robot that went straight through an empty room of 8 x 4 m, with a scanner of 180 degrees."""
    lines = []
    for step in range(9):
        x_m = 1.0 + 0.25 * step
        ranges = " ".join(f"{_to_the_walls_m(x_m, math.radians(deg)):.2f}" for deg in range(-90, 90))
        pose = f"{x_m} 2.0 0.0"
        lines.append(f"FLASER 180 {ranges} {pose} {pose} {step} host {step}")
    return "\n".join(lines) + "\n"


def _to_the_walls_m(x_m: float, bearing_rad: float) -> float:
    aside, ahead = abs(math.sin(bearing_rad)), math.cos(bearing_rad)
    return min(2.0 / max(aside, 1e-9), (8.0 - x_m) / max(ahead, 1e-9))


def _until_its_devices_are_ready(runtime_dir: Path) -> None:
    with Client(runtime_dir) as client, client.subscribe(Topic.STATUS) as events:
        while event := events.next(_PATIENCE_S):
            if isinstance(event, Status) and all(device.link is LinkState.READY for device in event.devices):
                return
    pytest.fail("the daemon fell silent before its devices were ready")


class Terminals:
    """A person at several terminals, in one directory."""

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._environment = {**os.environ, "PATH": f"{BIN}{os.pathsep}{os.environ['PATH']}", "COLUMNS": "100"}
        self._recording = "RECORDING"
        self._staying: list[tuple[str, subprocess.Popen[str]]] = []

    def type(self, command: str) -> str:
        """Do what the page says; return what was said to it."""
        typed = IN_THE_TEST.get(command, command).replace("RECORDING", self._recording)
        if not typed:
            return ""
        if typed.startswith("export "):
            name, _, value = typed.removeprefix("export ").partition("=")
            self._environment[name] = value
            return ""
        answer = self._stay(typed) if typed.startswith(STAYS) else self._run(typed)
        if command == "robotctl record stop":
            self._recording = answer.removeprefix("recorded ").strip()
        assert re.search(SAYS.get(command, ""), answer), f"{command}\n{answer}"
        return answer

    def _run(self, typed: str) -> str:
        done = subprocess.run(
            shlex.split(typed),
            check=False,
            cwd=self._directory,
            env=self._environment,
            capture_output=True,
            text=True,
            timeout=_PATIENCE_S,
        )
        assert done.returncode == 0, f"{typed}\nexit code {done.returncode}\n{done.stdout}{done.stderr}{self.end()}"
        return done.stdout

    def _stay(self, typed: str) -> str:
        """Start what stays, and return what it says until it is ready."""
        process = subprocess.Popen(
            shlex.split(typed),
            cwd=self._directory,
            env=self._environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        self._staying.append((typed, process))
        assert process.stdout is not None
        said = ""
        for line in process.stdout:
            said += line
            if re.search("Ctrl-C ends it|is ready$", line):
                break
        else:
            pytest.fail(f"{typed}: ended\n{said}")
        config = self._directory / re.findall(r"\S+/robotd\.toml", typed)[0]
        if typed.startswith("robotctl sim"):
            config.write_text(config.read_text(encoding="utf-8") + FASTER, encoding="utf-8")
        if typed.startswith("robotd "):
            _until_its_devices_are_ready(config.parent / "run")
        return said

    def end(self) -> str:
        """End what stays, boards before their daemons, who say stop when they end; return what all said meanwhile."""
        said = ""
        while self._staying:
            typed, process = self._staying.pop(0)
            process.send_signal(signal.SIGTERM)
            try:
                rest, _ = process.communicate(timeout=_PATIENCE_S)
            except subprocess.TimeoutExpired:
                process.kill()
                rest, _ = process.communicate()
            said += f"\n{typed}: exit code {process.returncode}\n{rest}"
        return said


@contextmanager
def terminals(directory: Path) -> Iterator[Terminals]:
    opened = Terminals(directory)
    try:
        yield opened
    finally:
        print(opened.end())  # pytest shows it if the test failed


def test_the_quick_start_can_be_typed_from_its_first_line_to_its_last(tmp_path: Path) -> None:
    (tmp_path / "building.log.gz").write_bytes(gzip.compress(carmen_log().encode()))
    with terminals(tmp_path) as person:
        answers = {command: person.type(command) for command in commands(ROOT / "docs" / "quickstart.md")}
        again = person.type("robotctl replay RECORDING")
        assert again == answers["robotctl replay RECORDING"], "two replays of one recording"
        first = json.loads(person.type("robotctl map show office --json --runtime-dir office/run"))
        fresh = json.loads(answers["robotctl map show --json"])
        assert fresh["digest"] == first["digest"], "the maps of the robot and of a fresh daemon on its fake"
        assert fresh["occupied_cells"] > 100
        end = person.end()
    assert set(re.findall(r"exit code (\S+)", end)) == {"0"}, end
    assert "0 requests were not the recorded ones" in end, end


def test_what_make_demo_runs_shows_the_main_job(tmp_path: Path) -> None:
    """A smaller room with fewer stops; the environment that ``make demo`` makes first needs a network."""
    recipe = subprocess.run(
        ["make", "-n", "--no-print-directory", "-o", ".venv/.demo", "demo"],
        check=True,
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert recipe.stdout.strip() == ".venv/bin/robotctl demo room laboratory --seed 1 --out demo"
    with terminals(tmp_path) as person:
        said = person.type("robotctl demo room office --seed 1 --out demo --stops 1 --localizations 1")
    assert re.search(r"2 stops, 600 readings taken: \d+ hits, \d+ misses, \d+ rejected", said)
    assert re.search(r"map saved: \S+/demo/maps/office/\d+ ", said)
    assert re.search(r"truth \[m\] +estimate \[m\](.|\n)+ \d+ / 300 +1 +localized", said)
    assert re.search(r"1 of 1 localized; median error \d{1,2} mm", said)
    assert sorted(file.name for file in (tmp_path / "demo").glob("*.png")) == [
        "localization.png",
        "map.png",
        "room.png",
    ]
    assert (tmp_path / "demo" / "recordings" / "recording.mcap").stat().st_size > 100_000
