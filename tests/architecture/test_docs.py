"""What the prose says is so: commands run, links lead somewhere, files and verbs that are named exist.

The commands of the quick start are executed by ``tests/integration/test_quickstart.py``, which knows no others.
"""

import argparse
import re
import shlex
import subprocess
import sys
from collections.abc import Callable, Collection
from dataclasses import fields
from functools import cache
from pathlib import Path

import pytest

from robotd.cli.main import WORDS, build_parser, verbs_of
from robotd.config import Config
from tests.integration.test_quickstart import commands

ROOT = Path(__file__).parents[2]
QUICK_START = ROOT / "docs" / "quickstart.md"
PAGES = sorted(
    [
        *ROOT.glob("*.md"),
        *ROOT.glob("docs/**/*.md"),
        ROOT / "tests" / "README.md",
        ROOT / "firmware_proto" / "PROTOCOL.md",
    ]
)
FILE = re.compile(r"(?:[\w-]+/)+[\w.-]*|[\w-]+\.(?:py|md|toml|service|rules)")
"""What looks like a file or a folder of the project: with a slash inside, or with the ending of our own sources."""
ENDINGS = ("py", "md", "toml", "service", "rules", "sock")
ROOMS = ("", "robotd", "firmware_proto", "tests", "docs", "systemd")
"""Where a path may begin: prose about a room leaves its name out."""
MADE = {
    "demo/": "made by make demo",
    "maps/": "made by the daemon, in its directory",
    "recordings/": "made by the daemon, in its directory",
    "office/": "made by the quick start",
    "building/": "made by the quick start",
    "again/": "made by the quick start",
}
"""What is not in a clone, and who makes it."""


def of_every_page(wrong_on: Callable[[Path], Collection[object]]) -> Callable[[], None]:
    """Make a test of what finds all that is wrong with a page: it names every page that has something."""

    def test() -> None:
        found = {str(page.relative_to(ROOT)): wrong for page in PAGES if (wrong := wrong_on(page))}
        assert found == {}

    return test


def prose(page: Path) -> str:
    """Return a page without its fenced blocks."""
    return re.sub(r"^ *```.*?^ *```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)


def in_backticks(page: Path) -> list[str]:
    return [" ".join(text.split()) for text in re.findall(r"`([^`]+)`", prose(page))]


@cache
def can_be_made(target: str) -> bool:
    """Whether make knows what to do; it does nothing of it."""
    tried = subprocess.run(["make", "-n", target, "LOG=a.log"], check=False, cwd=ROOT, capture_output=True)
    return tried.returncode == 0


@cache
def sources() -> str:
    """Return the text of all that may read a variable of the environment."""
    files = [*ROOT.glob("robotd/**/*.py"), ROOT / "tests/conftest.py"]
    return "".join(file.read_text(encoding="utf-8") for file in files)


@cache
def anchors(page: Path) -> set[str]:
    """Return the anchors of a page, made of its headings as GitHub makes them."""
    headings = re.findall(r"^#+ (.+)$", prose(page), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


def robotctl_accepts(typed: str) -> bool:
    """Whether a whole command line, or only the words of a verb or a family, is one of robotctl's."""
    words = shlex.split(typed)[1:]
    if words and all(re.fullmatch(r"[a-z-]+", word) for word in words) and words[0] in WORDS:
        names = [verb.name.split() for verb in verbs_of(words[0])]
        if words == words[:1] or words in names:
            return True
    try:
        parsed: argparse.Namespace = build_parser(words).parse_args(words)
    except SystemExit as leaving:
        return leaving.code == 0  # --help and --version
    return callable(parsed.run)


def exists(named: str) -> bool:
    return any((ROOT / room / named).exists() for room in ROOMS) or any(named.startswith(made) for made in MADE)


@of_every_page
def test_every_command_in_a_block_is_made_by_make_or_executed_by_the_test_of_the_quick_start(
    page: Path,
) -> Collection[object]:
    executed = commands(QUICK_START)
    assert len(executed) > 15, "the quick start is read"
    made = {command for command in commands(page) if command.startswith("make ")}
    cannot_be_made = [command for command in made if not can_be_made(command.split()[1])]
    return cannot_be_made + [command for command in commands(page) if command not in made and command not in executed]


@of_every_page
def test_every_block_of_commands_says_that_it_is_one(page: Path) -> Collection[object]:
    blocks = re.findall(r"^ *```(\w*)\n(.*?)^ *```", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    return [block for language, block in blocks if not language and re.search(r"^\s*(\$ )?(make|robot\w+) \w", block)]


@of_every_page
def test_every_target_of_make_that_is_named_exists(page: Path) -> Collection[object]:
    named = [text.split()[1] for text in in_backticks(page) if re.match(r"make [a-z]", text)]
    return [target for target in named if not can_be_made(target)]


@of_every_page
def test_every_command_line_of_robotctl_that_is_named_is_one(page: Path) -> Collection[object]:
    named = [text for text in [*in_backticks(page), *commands(page)] if text.startswith("robotctl ")]
    return [text for text in named if not robotctl_accepts(text)]


@of_every_page
def test_every_link_leads_somewhere(page: Path) -> Collection[object]:
    lost = []
    for link in re.findall(r"\]\(([^)\s]+)\)", prose(page)):
        if re.match(r"[a-z]+:", link):
            continue
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        if not target.exists() or (anchor and anchor not in anchors(target)):
            lost.append(link)
    return lost


@of_every_page
def test_every_file_that_is_named_exists(page: Path) -> Collection[object]:
    named = [text for text in in_backticks(page) if FILE.fullmatch(text)]
    return [text for text in named if not exists(text)]


@of_every_page
def test_every_key_of_the_configuration_that_is_named_exists(page: Path) -> Collection[object]:
    config = Config()
    sections = {field.name: getattr(config, field.name) for field in fields(config)}
    named = [text.split(".") for text in in_backticks(page) if re.fullmatch(r"[a-z]+\.[a-z0-9_]+", text)]
    keys = [(section, key) for section, key in named if section in sections and key not in ENDINGS]
    return [(section, key) for section, key in keys if not hasattr(sections[section], key)]


@of_every_page
def test_every_variable_of_the_environment_that_is_named_is_read(page: Path) -> Collection[object]:
    named = set(re.findall(r"\bROBOTD_[A-Z_]+", page.read_text(encoding="utf-8")))
    return {variable for variable in named if f'"{variable}"' not in sources()}


@of_every_page
def test_every_run_of_pytest_that_is_named_finds_tests(page: Path) -> Collection[object]:
    named = {text for text in in_backticks(page) if text.startswith("python -m pytest")}
    return [f"{typed}\n{said}" for typed in named if (said := complaint_of_pytest(typed))]


@cache
def complaint_of_pytest(typed: str) -> str:
    """Return what pytest says if it finds no tests, or not only such as it can collect."""
    words = shlex.split(typed.replace("=N", "=1"))[1:]
    options = ("--collect-only", "-q", "-p", "no:cacheprovider")
    found = subprocess.run([sys.executable, *words, *options], check=False, cwd=ROOT, capture_output=True, text=True)
    return "" if found.returncode == 0 else found.stdout + found.stderr


def test_the_example_of_every_verb_is_a_command_line_that_it_takes() -> None:
    examples = [verb.example.partition(" > ")[0] for word in WORDS for verb in verbs_of(word)]
    assert len(examples) >= 20
    assert [example for example in examples if not robotctl_accepts(example)] == []


def test_the_help_of_a_verb_tells_its_units(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        build_parser(["drive-to"]).parse_args(["drive-to", "--help"])
    assert "map x [m]" in capsys.readouterr().out
