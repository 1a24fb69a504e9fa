"""Whatever file a verb is given, it ends in words: one line or a few, an exit code, no traceback."""

import argparse
import gzip
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from robotd.cli.main import WORDS, main, verbs_of
from robotd.cli.outputs import OutputPath
from tests.support.carmen_room import flaser

LOG = "\n".join(flaser())
NOBODY = 65534
LINES_MAX = 3


def deep_json(path: Path) -> None:
    path.write_bytes(b"[" * 200_000)


def deep_toml(path: Path) -> None:
    path.write_bytes(b"a = " + b"[" * 100_000)


def broken_link(path: Path) -> None:
    path.symlink_to("nowhere")


def endless_link(path: Path) -> None:
    path.symlink_to(path.name)


BAD: dict[str, Callable[[Path], object]] = {
    "missing": lambda path: None,
    "a directory": Path.mkdir,
    "a directory with something in it": lambda path: (path / "x").mkdir(parents=True),
    "empty": Path.touch,
    "bytes": lambda path: path.write_bytes(bytes(range(256)) * 40),
    "zeros": lambda path: path.write_bytes(bytes(5000)),
    "words": lambda path: path.write_text("hello\nworld\n"),
    "Latin-1": lambda path: path.write_bytes(b"# caf\xe9\n" * 9),
    "packed nothing": lambda path: path.write_bytes(gzip.compress(b"")),
    "packed and cut": lambda path: path.write_bytes(gzip.compress(os.urandom(9000))[:-99]),
    "packed bytes": lambda path: path.write_bytes(gzip.compress(bytes(range(256)))),
    "JSON without end": deep_json,
    "TOML without end": deep_toml,
    "JSON of another kind": lambda path: path.write_text('{"type": 3, "features": null, "geometry": {"a": []}}'),
    "TOML of another kind": lambda path: path.write_text('[[wall]]\npoints_m = "far"\n[start]\n'),
    "MCAP and no more": lambda path: path.write_bytes(b"\x89MCAP0\r\n\x01\xff\xff\xff\xff\xff\xff\xff\x7f"),
    "a link to nowhere": broken_link,
    "a link to itself": endless_link,
    "a damaged log": lambda path: path.write_text("\n".join(line[:-60] for line in LOG.splitlines())),
}
OTHERS = {
    "exact map": ["READINGS"],
    "exact readings": ["MAP"],
    "import carmen log": ["--out", "NEW"],
    "import bag log": ["--out", "NEW"],
    "import csv log": ["--out", "NEW"],
    "demo building log": ["--out", "NEW"],
    "eval --config": ["LOG"],
    "map start --world": ["kitchen"],
    "map import file": ["--resolution", "0.05"],
    "map import --config": ["LOG"],
    "map import --maps": ["MAPYAML"],
    "map export --config": ["kitchen", "NEW"],
    "map export --maps": ["kitchen", "NEW"],
    "map changes --config": ["kitchen"],
    "map changes --maps": ["kitchen"],
    "map stops --config": ["kitchen"],
    "map stops --maps": ["kitchen"],
    "export tum file": ["NEW"],
    "export carmen file": ["NEW"],
    "export foxglove file": ["NEW"],
    "export bag file": ["NEW"],
    "report file": ["NEW"],
    "gateway token new --config": ["somebody"],
    "gateway token revoke --config": ["somebody"],
}
"""What else the command line needs for the verb to come as far as the bad file."""
MAP_YAML = b"image: in.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
ENDINGS = {"exact map": (".wkt", ".geojson", ".toml", "")}


def inputs() -> Iterator[tuple[str, str]]:
    """Every argument of every verb that names a file to read, and the option to put before it."""
    for word in WORDS:
        for verb in verbs_of(word):
            parser = argparse.ArgumentParser()
            verb.add_to(parser)
            for action in parser._actions:
                if is_input(action):
                    option = action.option_strings[0] if action.option_strings else ""
                    yield f"{verb.name} {option or action.dest}", option


def is_input(action: argparse.Action) -> bool:
    if action.dest in {"world", "runtime_dir"}:
        return True
    made = action.type("x") if callable(action.type) and action.metavar in {"FILE", "DIR", "LOG", "MAP"} else None
    return action.type is Path and not isinstance(made, OutputPath)


INPUTS = {name: option for name, option in inputs() if name != "record start file"}
ENOUGH = ("missing", "a directory", "empty", "a link to itself")
"""What a directory of sockets is tried as."""
GOOD = {
    *(
        (name, "empty")
        for name in (
            "eval --config",
            "config check file",
            "config show file",
            "doctor file",
            "gateway token list --config",
            "gateway token new --config",
        )
    ),
    *(("map import --maps", kind) for kind in ("missing", "a directory", "a directory with something in it")),
}
"""A configuration that leaves out everything is one; and a store of maps is made where there is none."""
CASES = [
    (name, kind)
    for name in INPUTS
    for kind in (ENOUGH if name.endswith("--runtime-dir") else BAD)
    if (name, kind) not in GOOD
]


def command(name: str, bad: Path, directory: Path) -> list[str]:
    verb, argument = name.rsplit(" ", 1)
    made = {
        "READINGS": directory / "in.csv",
        "MAP": directory / "in.wkt",
        "LOG": directory / "in.log",
        "NEW": directory / "new",
        "MAPYAML": directory / "in.yaml",
    }
    made["READINGS"].write_text("bearing_deg,range_m\n0,1\n")
    made["MAP"].write_text("POLYGON ((0 0, 1 0, 1 1, 0 0))")
    made["LOG"].write_text(LOG)
    made["MAPYAML"].write_bytes(MAP_YAML)
    (directory / "in.pgm").write_bytes(b"P5 2 1 255\n\0\xfe")
    others = [str(made.get(word, word)) for word in OTHERS.get(name, [])]
    if argument == "--runtime-dir":
        others += {
            "map start": ["x"],
            "map load": ["x"],
            "drive-to": ["0", "0"],
            "drive": ["0"],
            "turn": ["0"],
            "look": ["0", "0"],
        }.get(verb, [])
    others += {
        "map copy": ["hall", "other"],
        "map rename": ["hall", "other"],
        "map delete": ["hall", "--yes"],
        "map compare": ["hall", "other"],
    }.get(verb, [])
    if verb == "calibrate range":
        others += ["--wall", "1.5"]
    if verb.startswith("calibrate"):
        others += ["--yes"]
    given = [argument, str(bad)] if argument.startswith("--") else [str(bad)]
    before = others if name == "exact readings" else []
    return [*verb.split(), *before, *given, *(others if not before else [])]


@contextmanager
def nobody() -> Iterator[None]:
    """Root may read everything: be somebody who may not."""
    was = os.geteuid()
    if was == 0:
        os.seteuid(NOBODY)
    try:
        yield
    finally:
        os.seteuid(was)


def ends_in_words(words: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """Run a command line in this process; whatever it raises fails the test."""
    try:
        code: object = main(words)
    except SystemExit as left:
        code = left.code
    said = capsys.readouterr()
    assert code in {1, 2, 78}, said.out
    assert said.err.strip()
    assert "Traceback" not in said.err
    if code != 2:  # wrong usage prints how it is used, too
        assert len(said.err.splitlines()) <= LINES_MAX
    return said.err


@pytest.mark.parametrize(("name", "kind"), CASES)
def test_a_bad_file_ends_in_words(
    name: str, kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for ending in ENDINGS.get(name, ("",)):
        bad = tmp_path / f"bad{ending}"
        BAD[kind](bad)
        words = command(name, bad, tmp_path)
        if "--runtime-dir" in words:
            words += ["--timeout", "0.05"]
        ends_in_words(words, capsys)


@pytest.mark.parametrize("name", INPUTS)
def test_a_file_that_one_may_not_read_ends_in_words(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    locked = tmp_path / "locked"
    locked.mkdir()
    bad = locked / "bad.wkt"
    bad.write_text("x")
    words = command(name, bad, tmp_path)
    locked.chmod(0)
    with nobody():
        said = ends_in_words([*words, *(["--timeout", "0.05"] if "--runtime-dir" in words else [])], capsys)
    locked.chmod(0o700)
    assert "ermission denied" in said or "--runtime-dir" in words
