"""What ``doctor`` looks at, and what it says to do; and the configuration that ``config init`` makes."""

import json
import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from robotd.children.landlock import version
from robotd.cli.checkup import Check, checks
from robotd.cli.main import main
from robotd.config import Config, load
from robotd.hardware.devices.finding import Recognized


@pytest.fixture
def terminal() -> Iterator[str]:
    """A port that is there."""
    ours, theirs = os.openpty()
    yield os.ttyname(theirs)
    os.close(ours)
    os.close(theirs)


def config_of(tmp_path: Path, **ports: str) -> Config:
    config = Config()
    return replace(
        config,
        server=replace(config.server, runtime_dir=str(tmp_path / "run")),
        maps=replace(config.maps, dir=str(tmp_path / "maps")),
        recording=replace(config.recording, dir=str(tmp_path / "recordings")),
        **{device: replace(config.devices[device], port=port) for device, port in ports.items()},  # type: ignore[arg-type]  # each its own settings
    )


def test_each_finding_ends_in_its_remedy(tmp_path: Path, terminal: str) -> None:
    file = tmp_path / "file"
    file.touch()
    found = {check.what: check for check in checks(config_of(tmp_path, drive=terminal, rangefinder=str(file)))}
    assert str(found["pantilt"]).startswith("/dev/robotd/pantilt: no such file or directory: plug it in")
    assert "no serial port: name one in rangefinder.port" in str(found["rangefinder"])
    assert str(found["daemon"]).endswith("robotd --config FILE, or systemctl start robotd")
    assert found["drive"].what == "drive"
    assert found["maps"].is_well
    assert found["clock"].is_well


def test_what_keeps_a_daemon_from_its_ports_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robotd.cli.checkup._name", lambda process: "ModemManager")
    assert any("systemctl disable --now ModemManager" in str(check) for check in checks(config_of(tmp_path)))
    monkeypatch.setattr("robotd.cli.checkup.shutil.disk_usage", lambda path: _Full())
    assert "make room" in str(next(check for check in checks(config_of(tmp_path)) if check.what == "maps"))


def test_whether_the_kernel_confines_children_is_told_and_is_no_fault(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def told() -> Check:
        (check,) = (check for check in checks(config_of(tmp_path)) if check.what == "children")
        return check

    monkeypatch.setattr("robotd.cli.checkup.version", lambda: 7)
    assert "(Landlock, version 7)" in str(told())
    monkeypatch.setattr("robotd.children.landlock._CREATE_RULESET", -1)
    monkeypatch.setattr("robotd.cli.checkup.version", version)
    assert "no Landlock (Function not implemented" in str(told())
    assert told().is_well


class _Full:
    free = 1000


def test_doctor_fails_where_something_is_to_be_done(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "robotd.toml"
    devices = ["--drive", "/dev/none", "--pantilt", "tcp://head:1", "--rangefinder", "tcp://laser:2,lw20"]
    places = ["--set", "server.runtime_dir=run", "--set", "drive.counts_per_m=25000.0"]
    assert main(["config", "init", str(file), *devices, *places]) == 0
    config = load(file)
    assert (config.drive.counts_per_m, config.rangefinder.dialect) == (25_000.0, "lw20")
    assert config.server.runtime_dir == str(tmp_path / "run")
    capsys.readouterr()
    assert main(["doctor", str(file), "--json"]) == 1
    found = {one["what"]: one for one in json.loads(capsys.readouterr().out)["checks"]}
    assert found["drive"]["remedy"]
    assert not found["pantilt"]["remedy"]


def test_what_is_not_said_is_asked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    answers = iter(["/dev/a\n", "rflex\n", "/dev/b\n", "\n", "/dev/c\n", "tf-luna\n"])
    monkeypatch.setattr("sys.stdin.isatty", lambda: True)
    monkeypatch.setattr("sys.stdin.readline", lambda: next(answers))
    file = tmp_path / "robotd.toml"
    assert main(["config", "init", str(file)]) == 0
    config = load(file)
    assert [(one.port, one.dialect) for one in config.devices.values()] == [
        ("/dev/a", "rflex"),
        ("/dev/b", "board"),
        ("/dev/c", "tf-luna"),
    ]


def test_where_nobody_can_be_asked_the_option_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["config", "init", str(tmp_path / "robotd.toml")]) == 1
    assert "--drive PORT[,DIALECT]" in capsys.readouterr().err


@pytest.mark.parametrize("text", ["drive", "drive.port", "=1", ".a=1"])
def test_a_setting_that_is_none_is_wrong_usage(text: str, tmp_path: Path) -> None:
    with pytest.raises(SystemExit):
        main(["config", "init", str(tmp_path / "x.toml"), "--set", text])


def test_without_a_file_the_defaults_are_shown(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("ROBOTD_CONFIG", str(tmp_path / "none.toml"))
    assert main(["config", "show"]) == 0
    assert "counts_per_m = 27300.0" in capsys.readouterr().out


def test_those_that_answer_are_written_down_and_those_that_do_not_are_remarked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    answers: dict[str, Recognized | str] = {
        "/dev/a": Recognized("rangefinder", ("tfmini-s", "tf-luna"), "version 2.0.8"),
        "/dev/b": "busy: held by robotd",
        "/dev/c": Recognized("drive", ("board",), "our drive board"),
        "/dev/d": Recognized("drive", ("board",), "our drive board"),
    }
    asked: list[str] = []

    def who_answers(ports: list[str]) -> dict[str, Recognized | str]:
        asked.extend(ports)
        return {port: answers[port] for port in ports}

    monkeypatch.setattr("robotd.cli.who_answers.who_answers", who_answers)
    file = tmp_path / "robotd.toml"
    named = ["--pantilt", "/dev/e,ptu"]
    assert main(["config", "init", str(file), "--probe", *answers, "/dev/e", *named]) == 0
    assert asked == [*answers]  # what is named is not asked
    config = load(file)
    assert (config.rangefinder.port, config.rangefinder.dialect) == ("/dev/a", "tfmini-s")
    assert (config.drive.port, config.pantilt.dialect) == ("/dev/c", "ptu")
    assert "# It answers as tfmini-s, tf-luna all do: say which it is." in file.read_text()
    said = capsys.readouterr().err
    assert "/dev/b: busy: held by robotd" in said
    assert "/dev/d: drive, board: our drive board; left out, for there is one at /dev/c" in said
    assert main(["config", "init", str(file), "--probe", "/dev/a"]) == 0
    text = file.read_text()
    assert "# No drive answered (nobody asks for rwi-ascii or rflex: what is written to such a device may move" in text
    assert "\n[drive]" not in text
    answers["/dev/f"] = Recognized("rangefinder", ("scip",), "URG-04LX")
    assert main(["config", "init", str(file), "--probe", "/dev/f"]) == 0
    assert load(file).pantilt.dialect == "fixed"
    assert main(["config", "init", str(file), "--probe", "/dev/b"]) == 1
    assert "no device answered" in capsys.readouterr().err
