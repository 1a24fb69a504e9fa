"""``config check`` says all that is wrong; ``config show`` prints what loads to the same."""

import json
from pathlib import Path

import pytest

from robotd.cli.main import main
from robotd.config import load


@pytest.fixture
def bad(tmp_path: Path) -> Path:
    file = tmp_path / "bad.toml"
    file.write_text("[drive]\ndailect = 1\n\n[sweep]\nsettle_ms = 5\n")
    return file


def test_a_good_file_is_good(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "good.toml"
    file.write_text("[sweep]\nreadings = 100\n")
    assert main(["config", "check", str(file)]) == 0
    assert capsys.readouterr().out == f"{file}: good\n"
    assert main(["config", "check", str(file), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"file": str(file), "ok": True, "problems": []}


def test_a_bad_file_is_one_line_for_each_mistake_and_exit_code_78(
    bad: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["config", "check", str(bad)]) == 78
    assert capsys.readouterr().err.splitlines() == [
        f"{bad}:2: drive.dailect: unknown key; did you mean dialect?",
        f"{bad}:5: sweep.settle_ms: wrong unit: expected settle_s, in seconds",
    ]


def test_mistakes_as_json(bad: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["config", "check", str(bad), "--json"]) == 78
    document = json.loads(capsys.readouterr().out)
    assert document["ok"] is False
    assert document["problems"][1] == {
        "file": str(bad),
        "line": 5,
        "key": "sweep.settle_ms",
        "message": "wrong unit: expected settle_s, in seconds",
    }


def test_any_verb_that_meets_a_bad_file_says_so_with_exit_code_78(
    bad: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["config", "show", str(bad)]) == 78
    assert len(capsys.readouterr().err.splitlines()) == 2


def test_the_file_is_the_one_of_the_environment_if_none_is_named(
    bad: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("ROBOTD_CONFIG", str(bad))
    assert main(["config", "check"]) == 78
    assert capsys.readouterr().err.startswith(f"{bad}:2: ")


def test_what_is_shown_loads_to_the_same(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, full = tmp_path / "some.toml", tmp_path / "full.toml"
    file.write_text('[maps]\ndir = "here"\n[sweep]\ntilt_rad = -0.1\n')
    assert main(["config", "show", str(file)]) == 0
    full.write_text(capsys.readouterr().out)
    assert load(full) == load(file)
    assert main(["config", "show", str(file), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["sweep"]["tilt_rad"] == -0.1
