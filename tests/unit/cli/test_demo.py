"""What a demonstration does with what earlier ones left."""

from pathlib import Path
from unittest.mock import Mock

import pytest
from rich.console import Console

from robotd.cli.demo.rig import FINISHED, UNFINISHED, explained
from robotd.cli.demo.room import fresh, reachable
from robotd.cli.outputs import DEMO_MARK
from robotd.client import Client
from robotd.contract.ways import Hindrance, Way
from robotd.mission.safety.hold import TOO_BUSY
from robotd.sim.hosting.pace import SLOWED


def _left_behind(directory: Path, name: str, text: str) -> None:
    (directory / "maps" / name / "1").mkdir(parents=True)
    (directory / "maps" / name / "1" / "map.pgm").write_text(text)
    (directory / "robotd.log").write_text(text)


@pytest.mark.parametrize("name", [UNFINISHED, "laboratory"], ids=["failed", "killed"])
def test_the_map_of_each_that_did_not_come_to_its_end_is_kept_with_its_log(tmp_path: Path, name: str) -> None:
    directory = fresh(tmp_path)
    for text in ("first", "second"):
        _left_behind(directory, name, text)
        assert fresh(directory) == directory
        assert not (directory / "maps").exists()
    for number, text in enumerate(("first", "second"), 1):
        kept = directory / f"failed-{number}"
        assert (kept / "maps" / name / "1" / "map.pgm").read_text() == text
        assert (kept / "robotd.log").read_text() == text


def test_what_a_finished_one_left_goes(tmp_path: Path) -> None:
    directory = fresh(tmp_path)
    _left_behind(directory, "laboratory", "done")
    (directory / DEMO_MARK).write_bytes(FINISHED)
    fresh(directory)
    assert not (directory / "maps").exists()
    assert not list(directory.glob("failed-*"))
    _left_behind(directory, "laboratory", "killed")
    fresh(directory)
    assert (directory / "failed-1").exists(), "that one before it had finished says nothing"


def test_one_that_made_no_map_leaves_nothing_to_keep(tmp_path: Path) -> None:
    directory = fresh(tmp_path)
    (directory / "maps").mkdir()
    (directory / "maps" / ".lock").touch()
    (directory / "robotd.log").write_text("it did not begin")
    fresh(directory)
    assert not list(directory.glob("failed-*"))


@pytest.mark.parametrize(
    ("reason", "log"),
    [
        ("drive is gone: drive: silent for 10 s", ""),
        ("drive: no odometry for 0.5 s, for the 7th time within a minute", ""),
        ("pantilt: no answer to Aim in 9 tries", ""),
        ("drive: deadman", ""),
        ("the lease of mission 3 expired", f"devices are there\n{SLOWED}\n"),
        (f"drive: deadman; shortly before, {TOO_BUSY}: the loop stood still 0.4 s", ""),
    ],
)
def test_a_demonstration_that_fails_on_a_busy_machine_says_so_once(reason: str, log: str) -> None:
    words = explained(reason, None, log)
    assert words.startswith(reason)
    assert words.count(TOO_BUSY) == 1


@pytest.mark.parametrize(
    ("way", "goes_to_m"),
    [
        (Way(((1.0, 2.0),), 2.2), (1.0, 2.0)),
        (Way((), 0.0, Hindrance.OBSTACLE, "the goal lies in an obstacle", (0.8, 1.7)), (0.8, 1.7)),
        (Way((), 0.0, Hindrance.NO_WAY, "no way leads to the goal"), (1.0, 2.0)),
    ],
)
def test_where_a_wrong_range_lies_on_the_place_it_goes_next_to_it(way: Way, goes_to_m: tuple[float, float]) -> None:
    client = Mock(spec=Client, plan_to=lambda x_m, y_m: way)
    assert reachable(client, Console(quiet=True), (1.0, 2.0)) == goes_to_m


def test_what_has_another_cause_is_not_blamed_on_the_machine() -> None:
    assert explained("(3.00, 1.00) m cannot be reached", None, "") == "(3.00, 1.00) m cannot be reached"
    assert (
        explained("drive: silent for 10 s", -9, SLOWED) == "drive: silent for 10 s: the simulated robot ended with -9"
    )
