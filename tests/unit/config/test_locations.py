"""Files as people write them: with a byte order mark, with ``~`` and variables in their paths."""

from pathlib import Path

import pytest

from robotd.config import load
from robotd.core.errors import ConfigError


@pytest.fixture(autouse=True)
def _home(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", "/home/lily")
    monkeypatch.setenv("ROBOT", "lily")
    monkeypatch.setenv("PRICE", "$ROBOT")
    monkeypatch.setenv("NOTHING", "")
    monkeypatch.delenv("NOWHERE", raising=False)


def written(tmp_path: Path, text: str | bytes) -> Path:
    file = tmp_path / "r.toml"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    return file


def complaints(file: Path) -> list[str]:
    with pytest.raises(ConfigError) as caught:
        load(file)
    return [str(problem).removeprefix(f"{file}:") for problem in caught.value.problems]


def test_a_byte_order_mark_is_no_part_of_the_text(tmp_path: Path) -> None:
    file = written(tmp_path, b'\xef\xbb\xbf[drive]\nport = "/dev/ttyUSB0"\n')
    assert load(file).drive.port == "/dev/ttyUSB0"
    file = written(tmp_path, b'\xef\xbb\xbf[drive]\r\nport = "COM3"\r\n')
    assert complaints(file) == ['2: drive.port: must be a device path or tcp://host:port, got "COM3"']


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be", "utf-32"])
def test_a_text_in_utf_16_is_said_to_be_one(tmp_path: Path, encoding: str) -> None:
    file = written(tmp_path, ("[maps]\nkeep = 3\n").encode(encoding))
    [complaint] = complaints(file)
    assert complaint == "1: not TOML: UTF-16 or UTF-32; save it as UTF-8"


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("~/maps", "/home/lily/maps"),
        ("~", "/home/lily"),
        ("$HOME/maps", "/home/lily/maps"),
        ("${HOME}/maps", "/home/lily/maps"),
        ("/srv/${ROBOT}s/$ROBOT", "/srv/lilys/lily"),
        ("/srv/$PRICE", "/srv/$ROBOT"),
        ("/srv/a$/5$", "/srv/a$/5$"),
        ("/srv/~/a~b", "/srv/~/a~b"),
    ],
)
def test_a_directory_is_what_a_shell_makes_of_it(tmp_path: Path, path: str, expected: str) -> None:
    text = f'[server]\nruntime_dir = "{path}"\n[maps]\ndir = "{path}/m"\n[recording]\ndir = "{path}/r"\n'
    config = load(written(tmp_path, text))
    assert (config.server.runtime_dir, config.maps.dir) == (expected, f"{expected}/m")
    assert config.recording.dir == f"{expected}/r"


def test_a_variable_may_hold_a_relative_directory(tmp_path: Path) -> None:
    assert load(written(tmp_path, '[maps]\ndir = "$ROBOT/maps"\n')).maps.dir == str(tmp_path / "lily" / "maps")


def test_ports_may_be_named_by_variables_and_relative_ones_stay_refused(tmp_path: Path) -> None:
    text = '[drive]\nport = "~/drive"\n[pantilt]\nport = "tcp://${ROBOT}:4002"\n[rangefinder]\nport = "/dev/$ROBOT"\n'
    config = load(written(tmp_path, text))
    ports = [settings.port for settings in config.devices.values()]
    assert ports == ["/home/lily/drive", "tcp://lily:4002", "/dev/lily"]
    assert complaints(written(tmp_path, '[drive]\nport = "$ROBOT"\n')) == [
        '2: drive.port: must be a device path or tcp://host:port, got "lily"'
    ]


@pytest.mark.parametrize(
    ("path", "complaint"),
    [
        ("$NOWHERE/maps", "the environment has no variable NOWHERE: set it, or write the path out"),
        ("${NOWHERE}", "the environment has no variable NOWHERE: set it, or write the path out"),
        ("/srv/$NOTHING", "the environment has no variable NOTHING: set it, or write the path out"),
        ("/srv/${}", "the environment has no variable ${}: set it, or write the path out"),
        ("~nobody-of-this-name/maps", "~nobody-of-this-name is the home of nobody: write the path out"),
    ],
)
def test_what_cannot_be_replaced_is_named_beside_all_else(tmp_path: Path, path: str, complaint: str) -> None:
    file = written(tmp_path, f'[maps]\ndir = "{path}"\nkeep = 0\n[driving]\nspeed = 1\n')
    assert complaints(file) == [
        f"2: maps.dir: {complaint}",
        "3: maps.keep: must be 1 to 100000, got 0",
        "5: driving.speed: no unit: expected speed_mps, in metres per second",
    ]


def test_a_directory_too_deep_for_sockets_does_not_hide_the_rest(tmp_path: Path) -> None:
    file = written(tmp_path, f'[server]\nruntime_dir = "/{"a" * 120}"\nlease = 1\n[maps]\nkeep = 0\n')
    found = complaints(file)
    assert [line.split(": ")[0:2] for line in found] == [
        ["2", "server.runtime_dir"],
        ["3", "server.lease"],
        ["5", "maps.keep"],
    ]
