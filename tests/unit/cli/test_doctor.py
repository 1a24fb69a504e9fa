"""``doctor`` tells what is installed, which kernels are in use, and what is wrong with the configuration."""

import json
from pathlib import Path

import numpy as np
import pytest

from robotd import __version__
from robotd.cli.main import main
from robotd.grid import kernels


def test_it_names_versions_and_kernels(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("ROBOTD_CONFIG", str(tmp_path / "absent.toml"))
    assert main(["doctor"]) == 0
    said = capsys.readouterr().out
    for word in (__version__, np.__version__, str(kernels.IN_USE), "absent.toml: not there"):
        assert word in said


def test_json_says_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "good.toml"
    file.write_text("[sweep]\nreadings = 100\n")
    monkeypatch.setenv("ROBOTD_CONFIG", str(file))
    assert main(["doctor", "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["kernels"]["compiled"] == kernels.IN_USE.compiled
    assert said["config"] == {"file": str(file), "found": True, "problems": []}
    assert said["numpy"] == np.__version__


def test_a_configuration_with_mistakes_is_a_failure_that_names_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "bad.toml"
    file.write_text("[drive]\nbuad = 1\n")
    monkeypatch.setenv("ROBOTD_CONFIG", str(file))
    assert main(["doctor"]) == 1
    assert "buad" in capsys.readouterr().out
