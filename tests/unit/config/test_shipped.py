"""The configuration that is shipped says everything, and changes nothing."""

from dataclasses import asdict
from pathlib import Path

from robotd.config import Config, loads
from robotd.toml.lines import key_lines
from robotd.toml.problems import UNITS

FILE = Path(__file__).parents[3] / "systemd" / "robotd.toml"


def test_it_has_every_key_with_its_default() -> None:
    assert loads(FILE.read_text(), file="systemd/robotd.toml") == Config()
    keys = {path for path in key_lines(FILE.read_text()) if len(path) == 2}
    every = {(section, key) for section, values in asdict(Config()).items() for key in values}
    assert keys == every


def test_every_key_has_a_sentence_before_it_with_its_unit() -> None:
    lines = FILE.read_text().splitlines()
    for path, number in key_lines(FILE.read_text()).items():
        sentence = lines[number - 2]
        assert sentence.startswith("# "), path
        if path[-1].rpartition("_")[2] in UNITS:
            assert "[" in sentence, path


def test_it_is_as_wide_as_a_page() -> None:
    assert [line for line in FILE.read_text().splitlines() if len(line) > 120] == []
