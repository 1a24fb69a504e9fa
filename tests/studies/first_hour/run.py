"""``make first-hour``: what a new user does with a robot of their own, by commands alone, from a wheel in a bare venv.

A simulated robot stands in the place of one's own; the configuration that is made for it has wrong constants, as every
new robot's has. Prints how long each step takes, and how far the calibrations are from the truth.
"""

import argparse
import contextlib
import json
import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[3]
MAPS = ("skirk.yaml", "stata_basement.yaml", "willow-2010-02-18-0.10.yaml")
WRONG = {"counts_per_m": 25_000.0, "counts_per_rad": 4_400.0}
RIGHT = {
    # As the simulation has it: 27 300 and 4 096 counts, less its scale errors and its slip.
    "counts_per_m": 27_300.0 / 1.003 / 0.9995,
    "counts_per_rad": 4_096.0 / 1.0005,
    "pan_zero_rad": 0.0,
    "backlash_rad": 0.0,
    "range_bias_m": 0.0,
}
_READY_S = 120.0


@dataclass(slots=True)
class Hour:
    """Where it happens, and what is there by now."""

    directory: Path
    began_s: float = field(default_factory=time.monotonic)
    environment: dict[str, str] = field(default_factory=lambda: dict(os.environ))

    @property
    def bin(self) -> Path:
        return self.directory / "venv" / "bin"

    @contextlib.contextmanager
    def step(self, words: str) -> Iterator[None]:
        """Say what is done, and how long it took."""
        began_s = time.monotonic()
        print(f"{words:58}", end="", flush=True)
        yield
        print(f"{time.monotonic() - began_s:7.1f} s", flush=True)

    def run(self, *words: object, program: str = "robotctl") -> str:
        """Run a command to its end and return what it printed.

        Raises:
            SystemExit: it failed; says with what.
        """
        done = subprocess.run(
            [str(self.bin / program), *map(str, words)],
            cwd=self.directory,
            env=self.environment,
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode:
            sys.exit(
                f"\n{program} {' '.join(map(str, words))} ended with {done.returncode}:\n{done.stdout}{done.stderr}"
            )
        return done.stdout

    @contextlib.contextmanager
    def beside(self, program: str, *words: object) -> Iterator[None]:
        """Let a program run meanwhile, its output in a file of its name."""
        with (self.directory / f"{program}.log").open("ab") as log:
            process = subprocess.Popen(
                [str(self.bin / program), *map(str, words)],
                cwd=self.directory,
                env=self.environment,
                stdout=log,
                stderr=log,
            )
            try:
                yield
            finally:
                process.terminate()
                process.wait()

    def wait_for(self, path: Path) -> None:
        """Wait until a file is there."""
        end_s = time.monotonic() + _READY_S
        while not path.exists():
            if time.monotonic() > end_s:
                sys.exit(f"\n{path} did not come")
            time.sleep(0.1)

    @contextlib.contextmanager
    def daemon(self) -> Iterator[None]:
        """Let the daemon run, armed."""
        self.environment["ROBOTD_RUNTIME_DIR"] = str(self.directory / "run")
        with self.beside("robotd", "--config", "robotd.toml"):
            end_s = time.monotonic() + _READY_S
            while not self._is_ready():
                if time.monotonic() > end_s:
                    sys.exit("\nthe daemon did not come up")
                time.sleep(0.3)
            self.run("arm")
            yield

    def _is_ready(self) -> bool:
        asked = subprocess.run(
            [str(self.bin / "robotctl"), "status", "--json"],
            cwd=self.directory,
            env=self.environment,
            capture_output=True,
            text=True,
            check=False,
        )
        return asked.returncode == 0 and all(one["link"] == "ready" for one in json.loads(asked.stdout)["devices"])

    def truth(self) -> dict[str, Any]:
        """Where the robot really is."""
        *_, last = (self.directory / "truth.jsonl").read_text().splitlines()
        found: dict[str, Any] = json.loads(last)
        return found


def main() -> None:
    """Play the hour."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--maps", type=Path, help="where maps of real buildings are (default: below ROBOTD_DATA)")
    arguments = parser.parse_args()
    maps = arguments.maps or Path(os.environ.get("ROBOTD_DATA", "")) / "maps-real-buildings"
    if not all((maps / name).exists() for name in MAPS):
        sys.exit(f"{maps}: {', '.join(MAPS)} are not there: set ROBOTD_DATA, or say --maps DIR")
    with tempfile.TemporaryDirectory(prefix="first-hour-") as directory:
        hour = Hour(Path(directory))
        install(hour)
        calibrate(hour)
        maps_in_and_out(hour, maps)
        recording_for_others(hour)
        print(f"{'all of it':58}{time.monotonic() - hour.began_s:7.1f} s")


def install(hour: Hour) -> None:
    """A wheel into a bare environment."""
    with hour.step("build a wheel"):
        command = [
            sys.executable,
            "-m",
            "pip",
            "wheel",
            "-q",
            "--no-deps",
            "-w",
            hour.directory,
        ]
        subprocess.run([*map(str, command), str(ROOT)], check=True)
    with hour.step("install it into a bare environment"):
        subprocess.run([sys.executable, "-m", "venv", str(hour.directory / "venv")], check=True)
        (wheel,) = hour.directory.glob("robotd-*.whl")
        hour.run("install", "-q", "--disable-pip-version-check", f"{wheel}[interop,bags]", program="pip")


def calibrate(hour: Hour) -> None:
    """A configuration with wrong constants, and the robot finds the right ones."""
    links = hour.directory / "devices"
    with hour.beside("robotctl", "sim", "laboratory", "--links", links, "--truth", hour.directory / "truth.jsonl"):
        with hour.step("a simulated robot is plugged in"):
            hour.wait_for(links / "rangefinder")
        with hour.step("robotctl config init --probe, with wrong constants"):
            ports = [links / name for name in ("drive", "pantilt", "rangefinder")]
            places = ("server.runtime_dir=run", "maps.dir=maps", "recording.dir=recordings")
            # A simulated board that gets no processor is slow, and not gone.
            slow = [f"{name}.silence_s=10.0" for name in ("drive", "pantilt", "rangefinder")]
            # And a client that gets none keeps its lease all the same: nobody stands beside this robot.
            slow.append("server.lease_s=5.0")
            settings = [*places, *slow, *(f"drive.{key}={value}" for key, value in WRONG.items())]
            hour.run(
                "config", "init", "robotd.toml", "--probe", *ports, *(w for one in settings for w in ("--set", one))
            )
            hour.run("config", "check", "robotd.toml")
        for what in ("odometry", "heading", "head"):
            with hour.step(f"robotctl calibrate {what}"), hour.daemon():
                found = json.loads(hour.run("calibrate", what, "--yes", "--json", "--config", "robotd.toml"))
            tell(found)
        with hour.step("robotctl calibrate range, the wall behind by tape"), hour.daemon():
            hour.run("turn", "180")
            wall_m = f"{hour.truth()['x_m']:.3f}"  # the western wall of the laboratory is at 0
            found = json.loads(
                hour.run("calibrate", "range", "--wall", wall_m, "--yes", "--json", "--config", "robotd.toml")
            )
        tell(found)


def tell(found: list[dict[str, Any]]) -> None:
    """Say how far each constant is from the truth."""
    for one in found:
        right = RIGHT[one["key"]]
        off = one["value"] - right
        share = f"{100.0 * off / right:+.3f} %" if right else f"{off:+.4f} {one['unit']}"
        print(f"    {one['section']}.{one['key']}: {one['before']:g} -> {one['value']:.6g}, off by {share}")


def maps_in_and_out(hour: Hour, maps: Path) -> None:
    """Maps of real buildings, taken in, driven in, localized on, written out and read by others."""
    with hour.step("robotctl map import, three real buildings"):
        for name in MAPS:
            hour.run("map", "import", maps / name, "--config", "robotd.toml")
    links, truth = hour.directory / "devices", hour.directory / "truth.jsonl"
    truth.unlink(missing_ok=True)
    with hour.beside("robotctl", "sim", maps / MAPS[0], "--links", links, "--truth", truth):
        hour.wait_for(links / "rangefinder")
        with hour.daemon(), hour.step(f"robotctl localize in {MAPS[0]}, nothing known"):
            hour.run("record", "start", "hour.mcap")
            hour.run("map", "load", Path(MAPS[0]).stem)
            estimate = json.loads(hour.run("localize", "--heading-unknown", "--json"))
            hour.run("record", "stop")
        best, there = estimate["best"], hour.truth()
        off_m = math.hypot(best["x_m"] - there["x_m"], best["y_m"] - there["y_m"])
        print(f"    {estimate['state']}, {off_m:.3f} m from the truth")
    with hour.step("robotctl map export, read by PyYAML and Pillow"):
        name = Path(MAPS[0]).stem
        hour.run("map", "export", name, "exported", "--config", "robotd.toml")
        script = (
            "import sys, yaml, PIL.Image; d = sys.argv[1]; y = yaml.safe_load(open(f'{d}/{sys.argv[2]}.yaml'));"
            " p = PIL.Image.open(f\"{d}/{y['image']}\"); print(p.size, y['resolution'], y['origin'])"
        )
        said = hour.run("-c", script, "exported", name, program="python")
    print(f"    {said.strip()}")


def recording_for_others(hour: Hour) -> None:
    """What was recorded, written for other programs, and read by them."""
    recording = hour.directory / "recordings" / "hour.mcap"
    with hour.step("robotctl export tum, in the form that evo reads"):
        hour.run("export", "tum", recording, "hour.tum", "--predicted")
        poses = poses_of(hour.directory / "hour.tum")
    print(f"    {poses} poses")
    with hour.step("robotctl export bag, read by rosbags"):
        hour.run("export", "bag", recording, "hour.bag")
        script = (
            "import pathlib, rosbags.highlevel as r; bag = r.AnyReader([pathlib.Path('hour.bag')]); bag.open();"
            " print(', '.join(f'{one.topic} {one.msgcount}' for one in bag.connections)); bag.close()"
        )
        said = hour.run("-c", script, program="python")
    print(f"    {said.strip()}")
    with hour.step("robotctl export foxglove, read by mcap"):
        hour.run("export", "foxglove", recording, "hour-foxglove.mcap")
        script = (
            "import mcap.reader; file = open('hour-foxglove.mcap', 'rb');"
            " print(mcap.reader.make_reader(file).get_summary().statistics.message_count, 'messages')"
        )
        said = hour.run("-c", script, program="python")
    print(f"    {said.strip()}")


def poses_of(trajectory: Path) -> int:
    """Return how many poses a trajectory has that evo would read: time, place, unit quaternion; times rise.

    Raises:
        SystemExit: a line is none; names it.
    """
    lines = [line for line in trajectory.read_text().splitlines() if not line.startswith("#")]
    last_s = -math.inf
    for line in lines:
        numbers = [float(word) for word in line.split()]
        if len(numbers) != 8 or not numbers[0] > last_s or abs(math.hypot(*numbers[4:]) - 1.0) > 1e-6:
            sys.exit(f"\n{trajectory}: no pose: {line}")
        last_s = numbers[0]
    if not lines:
        sys.exit(f"\n{trajectory}: no poses")
    return len(lines)


if __name__ == "__main__":
    main()
