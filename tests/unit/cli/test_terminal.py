"""What is printed cannot steer the terminal, has a form on every terminal, and can be copied into a shell."""

import io
import os
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from rich.text import Text

from robotd.cli.show.half_blocks import Ink, Shrunk, draw
from robotd.cli.show.progress import MissionBars
from robotd.cli.show.terminal import command_line, complain, plain_console, print_pairs, print_table
from robotd.contract.events import MissionPhase, MissionProgress, Status

EVIL = "x\x1b[2J\x1b]0;title\x9b31m\u202e\u200b[red]y"
SHOWN = "x\\x1b[2J\\x1b]0;title\\x9b31m\\u202e\\u200b[red]y"


def test_control_sequences_come_out_as_letters(capsys: pytest.CaptureFixture[str]) -> None:
    file = io.StringIO()
    plain_console(file).print(EVIL)
    plain_console(file).print(Text(EVIL) + "\nsecond line")
    assert file.getvalue() == f"{SHOWN}\n{SHOWN}\nsecond line\n"
    complain(EVIL)
    print_pairs([("name", EVIL)])
    print_table(["name", EVIL], [(EVIL, 1)])
    said = capsys.readouterr()
    assert said.err == f"{SHOWN}\n"
    assert said.out.count(SHOWN) == 3
    assert all(line.isprintable() for line in said.out.splitlines())


def test_colours_of_our_own_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.delenv("NO_COLOR", raising=False)
    file = io.StringIO()
    plain_console(file).print(EVIL, style="red")
    # The colour alone, however the line break stands to it: each rich has its own mind about that.
    assert file.getvalue().replace("\n", "").startswith(f"\x1b[31m{SHOWN}\x1b[0m")


def test_progress_shows_foreign_words_as_letters(capsys: pytest.CaptureFixture[str]) -> None:
    with MissionBars() as bars:
        bars.show(MissionProgress(1, 1, "map", MissionPhase.FAILED, 0, 1, EVIL))
    assert "\x1b]0;" not in capsys.readouterr().err


def test_progress_shows_that_the_mission_is_held_and_why(capsys: pytest.CaptureFixture[str]) -> None:
    with MissionBars() as bars:
        for held in ("the loop stood still", None):
            bars.show(Status(1, "mapping", "", (), None, (), 1, None, None, None, held))
    told = capsys.readouterr().err
    assert "held: the loop stood still" in told
    assert "the mission goes on" in told


@pytest.mark.parametrize("name", ["a b.mcap", "it's", "$HOME", "a;rm -rf b", "a\tb", "Büro"])
def test_a_command_can_be_copied(name: str) -> None:
    assert shlex.split(command_line("robotctl", "replay", Path(name))) == ["robotctl", "replay", name]


def test_no_command_is_printed_unquoted() -> None:
    """A command with a name in it is made by ``command_line`` alone."""
    sources = Path(__file__).parents[3] / "robotd"
    words = ("robotctl ", "robotd --config ", "pip install -e ")
    lines = [line for file in sources.rglob("*.py") for line in file.read_text().splitlines()]
    found = [line.strip() for line in lines for word in words if word in line and "{" in line.split(word, 1)[1]]
    found = [line for line in found if "{__version__}" not in line]
    assert [line for line in found if "command_line(" not in line] == []


def test_a_map_has_a_form_in_ascii() -> None:
    shrunk = Shrunk(np.array([[0, 255, 0, 255, 128], [0, 0, 255, 255, 128]], np.uint8), 0.0, 0.2, 0.1)
    for blocks, inked in ((True, " ▀▄█░"), (False, " '.#:")):
        line, _ = draw(shrunk, Ink(colour=False, blocks=blocks)).plain.splitlines()
        assert line == f"    0.10|{inked}"


@pytest.mark.parametrize("environment", [{"PYTHONIOENCODING": "ascii"}, {"PYTHONIOENCODING": "latin-1"}])
def test_no_letter_ends_robotctl_on_a_poor_terminal(tmp_path: Path, environment: dict[str, str]) -> None:
    file = tmp_path / "Büro▀.toml"
    file.write_text("[sweep]\nreadings = 100\n", encoding="utf-8")
    words = [sys.executable, "-m", "robotd.cli.main", "config", "check", str(file)]
    done = subprocess.run(words, check=False, capture_output=True, env=os.environ | environment)
    assert (done.returncode, done.stderr) == (0, b"")
    assert b"\\u2580.toml: good" in done.stdout
