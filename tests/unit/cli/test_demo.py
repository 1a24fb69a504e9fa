"""What a demonstration does with what earlier ones left."""

from pathlib import Path

from robotd.cli.demo.rig import UNFINISHED, slowed
from robotd.cli.demo.room import fresh
from robotd.sim.pace import SLOWED


def _left_behind(directory: Path, name: str, text: str) -> None:
    (directory / "maps" / name / "1").mkdir(parents=True)
    (directory / "maps" / name / "1" / "map.pgm").write_text(text)
    (directory / "robotd.log").write_text(text)


def test_the_map_of_each_that_failed_is_kept_with_its_log(tmp_path: Path) -> None:
    directory = fresh(tmp_path)
    for text in ("first", "second"):
        _left_behind(directory, UNFINISHED, text)
        assert fresh(directory) == directory
        assert not (directory / "maps").exists()
    for number, text in enumerate(("first", "second"), 1):
        kept = directory / f"failed-{number}"
        assert (kept / "maps" / UNFINISHED / "1" / "map.pgm").read_text() == text
        assert (kept / "robotd.log").read_text() == text


def test_what_a_finished_one_left_goes(tmp_path: Path) -> None:
    directory = fresh(tmp_path)
    _left_behind(directory, "laboratory", "done")
    fresh(directory)
    assert not (directory / "maps").exists()
    assert not list(directory.glob("failed-*"))


def test_a_demonstration_that_fails_on_a_busy_machine_says_so() -> None:
    assert slowed(f"devices are there\n{SLOWED}\ndrive: silent for 1 s\n").startswith("; this machine is busy")
    assert slowed("devices are there\ndrive: silent for 1 s\n") == ""
