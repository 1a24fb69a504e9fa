"""What a verb was told to write never costs what was there."""

import argparse
import os
import shlex
import stat
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from robotd.cli import outputs
from robotd.cli.main import WORDS, build_parser, main, verbs_of
from robotd.cli.outputs import DEMO_MARK, OutputPath, write
from robotd.core.errors import RobotdError
from tests.support.carmen_room import flaser

ROOT = Path(__file__).parents[3]
LOG = "\n".join(flaser()) + "\n"
PRECIOUS = {
    "a log": LOG.encode(),
    "a table": b"bearing_deg,range_m\n0,1.5\n",
    "a configuration made by hand": b"[drive]\nport = '/dev/ttyUSB0'\n",
    "a document of others": b'{"name": "somebody else"}',
    "bytes": bytes(range(256)),
}
OUTPUTS = {
    "import carmen --out",
    "import bag --out",
    "import csv --out",
    "exact --out",
    "map show --png",
    "map compare --png",
    "calibrate odometry --png",
    "calibrate heading --png",
    "calibrate head --png",
    "calibrate range --png",
    "map export directory",
    "config init file",
    "export tum out",
    "export carmen out",
    "export foxglove out",
    "export bag out",
    "report out",
    "sim --truth",
    "sim --links",
    "sim --write-config",
    "fake --links",
    "fake --write-config",
    "eval --pictures",
    "eval --json",
    "demo room --out",
    "demo building --out",
    "demo console --out",
}
NO_OUTPUTS = {"--prefix", "--root", "--runtime-dir", "--config", "--maps", "log", "map", "readings", "file"}
"""Paths that are read; ``record start FILE`` is the daemon's to refuse, which has the file."""


def options() -> Iterator[tuple[str, argparse.Action]]:
    """Every argument of every verb that may be a path."""
    for word in WORDS:
        for verb in verbs_of(word):
            parser = argparse.ArgumentParser()
            verb.add_to(parser)
            for action in parser._actions:
                yield f"{verb.name} {action.option_strings[0] if action.option_strings else action.dest}", action


def kind_of(action: argparse.Action) -> outputs.Kind | None:
    made: Any = action.type("x") if callable(action.type) and action.type is not Path and is_path(action) else None
    return made.kind if isinstance(made, OutputPath) else None


def is_path(action: argparse.Action) -> bool:
    return action.metavar in {"FILE", "DIR"} or action.type is Path


def test_every_option_that_names_a_file_is_known_to_be_read_or_written() -> None:
    paths = {name: action for name, action in options() if is_path(action)}
    written = {name for name, action in paths.items() if kind_of(action) is not None}
    assert written == OUTPUTS
    assert {name.rsplit(" ", 1)[1] for name in paths if name not in written} <= NO_OUTPUTS


def command(name: str, target: Path, directory: Path) -> list[str]:
    """A command line that is right but for where it writes."""
    log, table, square = directory / "in.log", directory / "in.csv", directory / "in.wkt"
    log.write_text(LOG)
    table.write_text("bearing_deg,range_m\n0,1\n")
    square.write_text("POLYGON ((0 0, 1 0, 1 1, 0 0))")
    verb, option = name.rsplit(" ", 1)
    needed = {
        "import carmen": [str(log)],
        "import bag": [str(log)],
        "import csv": [str(log)],
        "exact": [str(square), str(table)],
        "map export": ["hall"],
        "calibrate range": ["--wall", "1.5"],
        "map compare": ["hall", "hall"],
        "export tum": [str(directory / "no.mcap")],
        "export carmen": [str(directory / "no.mcap")],
        "export foxglove": [str(directory / "no.mcap")],
        "export bag": [str(directory / "no.mcap")],
        "report": [str(directory / "no.mcap")],
        "sim": ["office"],
        "config init": ["--drive", "a", "--pantilt", "b", "--rangefinder", "c"],
        "fake": [str(directory / "no.mcap")],
        "eval": [str(log), "--cases", "1"],
        "demo building": [str(log)],
        "demo room": ["office"],
    }
    words = [option, str(target)] if option.startswith("-") else [str(target)]
    return [*verb.split(), *needed.get(verb, []), *words]


@pytest.mark.parametrize("content", PRECIOUS.values(), ids=PRECIOUS)
@pytest.mark.parametrize("name", sorted(OUTPUTS))
def test_a_file_of_another_kind_is_left_as_it_is(
    name: str, content: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    target = tmp_path / "precious"
    target.write_bytes(content)
    assert main(command(name, target, tmp_path)) == 1
    said = capsys.readouterr().err
    assert said.startswith(f"robotctl: {target}: is ")
    assert said.endswith("it is left as it is\n")
    assert len(said.splitlines()) == 1
    assert target.read_bytes() == content


@pytest.mark.parametrize("link", [os.symlink, os.link])
def test_a_file_is_not_written_over_itself_by_any_name(
    link: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    config = tmp_path / "made.toml"
    config.write_text("# Made by robotctl for emulated devices\n")
    link(config, tmp_path / "other.toml")
    words = ["sim", str(config), "--write-config", str(tmp_path / "other.toml")]
    assert main(words) == 1
    assert "would be written over" in capsys.readouterr().err
    empty = tmp_path / "empty"
    empty.touch()
    assert main(["sim", "office", "--truth", str(empty), "--write-config", str(empty)]) == 1
    assert "names, too" in capsys.readouterr().err


def test_a_log_is_not_written_over_even_if_it_is_empty_or_a_building(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    building = tmp_path / "a.building"
    log = tmp_path / "a.log"
    log.write_text(LOG)
    assert main(["import", "carmen", str(log), "--out", str(building)]) == 0
    first = building.read_bytes()
    assert main(["import", "carmen", str(building), "--out", str(building)]) == 1
    assert building.read_bytes() == first
    assert main(["import", "carmen", str(log), "--out", str(building), "--spacing-m", "0.1"]) == 0
    assert building.read_bytes() != first
    capsys.readouterr()


def test_a_directory_that_no_demonstration_made_is_not_cleared(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    kept = tmp_path / "maps" / "lab"
    kept.mkdir(parents=True)
    (tmp_path / "holiday.png").touch()
    assert main(["demo", "room", "office", "--out", str(tmp_path)]) == 1
    assert "is not empty, and is not the directory of a demonstration" in capsys.readouterr().err
    assert kept.is_dir()
    assert (tmp_path / "holiday.png").exists()


def test_a_log_inside_the_directory_of_a_demonstration_is_not_cleared_away(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / DEMO_MARK).touch()
    (tmp_path / "recordings").mkdir()
    log = tmp_path / "recordings" / "a.log"
    log.write_text(LOG)
    assert main(["demo", "building", str(log), "--out", str(tmp_path)]) == 1
    assert "which is cleared first" in capsys.readouterr().err
    assert log.read_text() == LOG


def test_a_file_is_written_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "new" / "a.txt"
    write(file, b"one")
    file.chmod(0o640)

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("robotd.cli.outputs.os.fsync", full)
    with pytest.raises(RobotdError, match=r"a\.txt: No space left"):
        write(file, b"two")
    monkeypatch.undo()
    assert file.read_bytes() == b"one"
    assert [entry.name for entry in file.parent.iterdir()] == ["a.txt"]
    write(file, b"three")
    assert file.read_bytes() == b"three"
    assert stat.S_IMODE(file.stat().st_mode) == 0o640


def test_a_link_stays_a_link_and_what_is_no_plain_file_is_written_to(tmp_path: Path) -> None:
    (tmp_path / "real").write_bytes(b"one")
    (tmp_path / "link").symlink_to("real")
    write(tmp_path / "link", b"two")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_bytes() == b"two"
    write(Path(os.devnull), b"gone")
    assert stat.S_ISCHR(Path(os.devnull).stat().st_mode)


@pytest.mark.parametrize("redirected", [" > FILE", " | cat > FILE"])
def test_the_name_of_standard_output_is_standard_output(redirected: str, tmp_path: Path) -> None:
    program = "from pathlib import Path; from robotd.cli.outputs import write; write(Path('/dev/stdout'), b'said')"
    file = tmp_path / "said"
    command = f"{shlex.quote(sys.executable)} -c {shlex.quote(program)}{redirected.replace('FILE', str(file))}"
    subprocess.run(command, shell=True, check=True, cwd=ROOT)
    assert file.read_bytes() == b"said"


def test_the_default_of_a_demonstration_is_looked_at_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "demo").mkdir()
    (tmp_path / "demo" / "thesis.tex").touch()
    assert isinstance(build_parser(["demo"]).parse_args(["demo", "room"]).out, OutputPath)
    assert main(["demo", "room"]) == 1
    assert "demo: is not empty" in capsys.readouterr().err
