"""``doctor`` tells what is installed, which kernels are in use, and what is wrong with the configuration."""

import json
import os
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from robotd import __version__
from robotd.cli.main import main
from robotd.cli.verbs import doctor
from robotd.grid import kernels


def test_it_names_versions_and_kernels(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("ROBOTD_CONFIG", str(tmp_path / "absent.toml"))
    assert main(["doctor"]) == 0
    said = capsys.readouterr().out
    for word in (__version__, np.__version__, str(kernels.in_use().about), "absent.toml: not there"):
        assert word in said


def test_json_says_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "good.toml"
    file.write_text("[sweep]\nreadings = 100\n")
    monkeypatch.setenv("ROBOTD_CONFIG", str(file))
    assert main(["doctor", "--json"]) == 1  # the devices of the defaults are not plugged in
    said = json.loads(capsys.readouterr().out)
    assert said["kernels"]["compiled"] == kernels.in_use().about.compiled
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


@pytest.mark.parametrize(("age_s", "clone", "code"), [(-10.0, True, 0), (10.0, True, 1), (10.0, False, 0)])
def test_a_library_older_than_its_source_is_a_failure_that_names_the_source(
    age_s: float,
    clone: bool,
    code: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv("ROBOTD_CONFIG", str(tmp_path / "absent.toml"))
    library, source = tmp_path / "robotd/lib.so", tmp_path / "firmware_proto/c/frame.c"
    for file in (library, source):
        file.parent.mkdir(parents=True)
        file.touch()
    if clone:
        (tmp_path / "setup.py").touch()
    now_s = library.stat().st_mtime
    os.utime(source, (now_s + age_s, now_s + age_s))
    monkeypatch.setattr(doctor, "_ROOT", tmp_path)
    monkeypatch.setattr("importlib.util.find_spec", lambda _: SimpleNamespace(origin=str(library)))
    assert main(["doctor"]) == code
    assert (f"frame.c: run pip install -e {tmp_path}" in capsys.readouterr().out) == bool(code)


def test_what_was_not_compiled_is_said_and_no_failure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("ROBOTD_CONFIG", str(tmp_path / "absent.toml"))
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    assert main(["doctor"]) == 0
    assert "not compiled" in capsys.readouterr().out
