"""The daemon's own configuration: files, directories, what must agree between sections."""

import math
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.config import Config, default_path, effective_text, load, loads
from robotd.core.errors import ConfigError
from robotd.hardware.devices.dialect_options import DimetixSettings, DynamixelSettings


def complaints(text: str) -> list[str]:
    with pytest.raises(ConfigError) as caught:
        loads(text, file="r.toml")
    return [str(problem) for problem in caught.value.problems]


def test_nothing_at_all_is_a_configuration() -> None:
    assert loads("") == Config()


@settings(max_examples=25)
@given(
    readings=st.integers(1, 10_000),
    tilt_rad=st.floats(-1.4, 1.4),
    port=st.text(st.characters(exclude_categories=["Cs", "Cc"]), max_size=20),
    from_start=st.booleans(),
)
def test_the_effective_text_loads_to_the_same(readings: int, tilt_rad: float, port: str, from_start: bool) -> None:
    plain = Config()
    config = replace(
        plain,
        sweep=replace(plain.sweep, readings=readings, tilt_rad=tilt_rad),
        drive=replace(plain.drive, port="/dev/x" + port),
        recording=replace(plain.recording, from_start=from_start),
    )
    assert loads(effective_text(config)) == config


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("[laser]\nx = 1", "r.toml:1: laser: unknown section"),
        ("[rangfinder]\nx = 1", "r.toml:1: rangfinder: unknown section; did you mean rangefinder?"),
        ("port = 9600", "r.toml:1: port: unknown section"),
        ("[drive]\ndailect = 9600", "r.toml:2: drive.dailect: unknown key; did you mean dialect?"),
        (
            "[rangefinder]\nrange_max_mm = 6000",
            "r.toml:2: rangefinder.range_max_mm: wrong unit: expected range_max_m, in metres",
        ),
        (
            "[drive]\ntelemetry_s = 0.04",
            "r.toml:2: drive.telemetry_s: wrong unit: expected telemetry_ms, in milliseconds",
        ),
        ("[driving]\nspeed = 0.4", "r.toml:2: driving.speed: no unit: expected speed_mps, in metres per second"),
        ("[driving]\nspeed_mps = 0", "r.toml:2: driving.speed_mps: must be 0.01 to 5 m/s, got 0"),
        ("[drive]\nport = ''", "r.toml:2: drive.port: must not be empty"),
        ("[drive]\nport = 'COM3'", 'r.toml:2: drive.port: must be a device path or tcp://host:port, got "COM3"'),
        (
            "[pantilt]\ndialect = 'fixed'",
            (
                'r.toml:2: pantilt.dialect: must be "fixed" if rangefinder.dialect is a scanner (scip), and only then; '
                'got "fixed" and "board"'
            ),
        ),
        (
            "[pantilt]\npan_min_rad = 1.0\ndialect = 'fixed'\npan_max_rad = 0.5\n[rangefinder]\ndialect = 'scip'",
            "r.toml:2: pantilt.pan_min_rad: must be less than pan_max_rad, got 1.0, 0.5",
        ),
        (
            "[pantilt]\ndialect = 'ptu'\npan_id = 3",
            'r.toml:3: pantilt.pan_id: is an option of dialect dynamixel, and not of "ptu": leave it out',
        ),
        (
            "[rangefinder]\ndevice_id = 3",
            'r.toml:2: rangefinder.device_id: is an option of dialect dimetix, and not of "board": leave it out',
        ),
        (
            "[drive]\ndialect = 'rwi-ascii'\nttl_max_ms = 600",
            'r.toml:3: drive.ttl_max_ms: is an option of dialect board, and not of "rwi-ascii": leave it out',
        ),
        (
            "[rangefinder]\ndialect = 'dimetix'\ndevice_id = 10",
            "r.toml:3: rangefinder.device_id: must be 0 to 9, got 10",
        ),
        (
            "[pantilt]\ndialect = 'dynamixel'\npan_id = 2",
            "r.toml:3: pantilt.pan_id: tilt_id must differ from pan_id, got 2 twice",
        ),
        (
            "[pantilt]\ndialect = 'klingon'",
            'r.toml:2: pantilt.dialect: must be one of board, ptu, fixed, dynamixel; got "klingon"',
        ),
        (
            "[drive]\nport = '/dev/a'\n[pantilt]\nport = '/dev/a'",
            "r.toml:4: pantilt.port: must not be the port of another device, got drive.port",
        ),
        (
            "[driving]\nsetpoint_ttl_s = 2",
            "r.toml:2: driving.setpoint_ttl_s: must be within drive.ttl_max_ms, got 2.0 s and 500 ms",
        ),
        (
            "[drive]\nttl_max_ms = 100",
            "r.toml:2: drive.ttl_max_ms: driving.setpoint_ttl_s must be within drive.ttl_max_ms, got 0.4 s and 100 ms",
        ),
        (
            "[driving]\nsilence_s = 0.01",
            "r.toml:2: driving.silence_s: must be longer than drive.telemetry_ms, got 0.01 s and 40 ms",
        ),
        (
            "[grid]\npolicy = 'per_beam'",
            'r.toml:2: grid.policy: expected one of per_reading, per_sweep; got "per_beam"; did you mean per_reading?',
        ),
        ("[maps]\nkeep = 0", "r.toml:2: maps.keep: must be 1 to 100000, got 0"),
        ("[recording]\npreroll_bytes = -1", "r.toml:2: recording.preroll_bytes: must be 0 to 4294967296 bytes, got -1"),
        (
            "[server]\nmap_queue = 99999999999",
            "r.toml:2: server.map_queue: must be 1 to 1000000, got 99999999999",
        ),
        ('[maps]\ndir = "a\\u0000b"', "r.toml:2: maps.dir: must not contain a zero byte"),
        ("[server]\nlease_s = 60", "r.toml:2: server.lease_s: must be 0.1 to 10 s, got 60"),
    ],
)
def test_a_mistake_is_named_where_it_stands(text: str, complaint: str) -> None:
    assert complaints(text) == [complaint]


def test_mistakes_between_sections_are_all_found() -> None:
    text = "[driving]\nsetpoint_ttl_s = 2\n[pantilt]\nport = 'COM3'\n[grid]\nrows = 0"
    assert [line.split(": ")[1] for line in complaints(text)] == ["driving.setpoint_ttl_s", "pantilt.port", "grid.rows"]


HIDDEN_BY_AN_UNKNOWN_KEY = """
[drive]
dailect = "board"
port = "COM3"
counts_per_m = 3.7e-5
[pantilt]
klingon = 1
dialect = "klingon"
port = "/dev/robotd/rangefinder"
[driving]
speed = 0.4
turn_radps = 57
setpoint_ttl_s = 2
silence_s = 0.01
[laser]
[grid]
resolution_m = 1.0
rows = "many"
"""


def test_an_unknown_key_hides_nothing_of_its_section_nor_of_others() -> None:
    assert [line.split(": ")[0:2] for line in complaints(HIDDEN_BY_AN_UNKNOWN_KEY)] == [
        ["r.toml:3", "drive.dailect"],
        ["r.toml:4", "drive.port"],
        ["r.toml:5", "drive.counts_per_m"],
        ["r.toml:7", "pantilt.klingon"],
        ["r.toml:8", "pantilt.dialect"],
        ["r.toml:9", "pantilt.port"],
        ["r.toml:11", "driving.speed"],
        ["r.toml:12", "driving.turn_radps"],
        ["r.toml:13", "driving.setpoint_ttl_s"],
        ["r.toml:14", "driving.silence_s"],
        ["r.toml:15", "laser"],
        ["r.toml:17", "grid.resolution_m"],
        ["r.toml:18", "grid.rows"],
    ]


def test_what_follows_from_a_mistake_is_not_a_second_one() -> None:
    text = "[rangefinder]\ndialect = 1\n[pantilt]\ndialect = 'fixed'\n[drive]\ntelemetry_ms = 1000\n"
    assert [line.split(": ")[1] for line in complaints(text)] == ["rangefinder.dialect", "drive.telemetry_ms"]


@pytest.mark.parametrize(
    ("maps", "recordings"),
    [
        ("/srv/x", "/srv/x"),
        ("/srv/x", "/srv/x/maps/"),
        ("/srv/x/y/z", "/srv/x"),
        ("/srv/x", "/srv/./y/../x/a"),
        ("a", "a/b"),
    ],
)
def test_recordings_and_maps_lie_apart(maps: str, recordings: str, tmp_path: Path) -> None:
    text = f'[maps]\ndir = "{maps}"\n[recording]\ndir = "{recordings}"\n'
    (found,) = complaints(text)
    assert found.startswith("r.toml:4: recording.dir: must not be maps.dir, nor lie in it, nor the other way round")
    (tmp_path / "robotd.toml").write_text(f'[maps]\ndir = "{tmp_path}/a"\n[recording]\ndir = "a/b"\n')
    with pytest.raises(ConfigError, match=r"robotd.toml:4: recording.dir: must not be maps.dir"):
        load(tmp_path / "robotd.toml")
    assert loads('[maps]\ndir = "/srv/x"\n[recording]\ndir = "/srv/x-2"\n').recording.dir == "/srv/x-2"


def test_a_slant_that_meets_the_floor_before_the_cut_off_is_refused() -> None:
    slanted = "[pantilt]\nheight_m = {}\n[sweep]\ntilt_rad = {}\n[rangefinder]\nrange_max_m = 2.1\n"
    (found,) = complaints(slanted.format(0.5, -0.24))
    assert found.startswith("r.toml:4: sweep.tilt_rad: must be such that the beam meets the floor beyond")
    assert "2.04 m" in found
    for height_m, tilt_rad in ((0.55, -0.24), (0.5, 0.24), (0.5, 0.0), (0.0, -0.24)):
        assert loads(slanted.format(height_m, tilt_rad)).sweep.tilt_rad == tilt_rad


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    with pytest.raises(
        ConfigError, match=r"none.toml: there is no such file; make one, with: robotctl config init \S*none.toml$"
    ):
        load(tmp_path / "none.toml")
    bad = tmp_path / "latin.toml"
    bad.write_bytes(b"[maps]\n# caf\xe9\n")
    with pytest.raises(ConfigError, match=r"latin.toml:2: not TOML: not UTF-8$"):
        load(bad)


def test_directories_begin_where_the_file_is(tmp_path: Path) -> None:
    file = tmp_path / "robotd.toml"
    file.write_text('[server]\nruntime_dir = "run"\n[maps]\ndir = "maps"\n')
    config = load(file)
    assert config.server.runtime_dir == str(tmp_path / "run")
    assert config.maps.dir == str(tmp_path / "maps")
    assert config.recording.dir == "/var/lib/robotd/recordings"
    assert loads(effective_text(config)) == config


@pytest.mark.parametrize("name", ["a" * 100, "/" + "a" * 120])
def test_a_directory_too_deep_for_sockets_is_named(tmp_path: Path, name: str) -> None:
    file = tmp_path / "robotd.toml"
    file.write_text(f'[maps]\nkeep = 3\n[server]\nruntime_dir = "{name}"\n')
    with pytest.raises(
        ConfigError, match=r"robotd.toml:4: server.runtime_dir: .*a Unix socket's path has at most 107$"
    ):
        load(file)


def test_directories_are_those_that_systemd_made(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RUNTIME_DIRECTORY", "/run/other")
    monkeypatch.setenv("STATE_DIRECTORY", "/srv/state:/srv/more")
    config = loads("[server]\nlease_s = 1\n[maps]\nkeep = 2")
    assert config.server.runtime_dir == "/run/other"
    assert (config.maps.dir, config.recording.dir) == ("/srv/state/maps", "/srv/state/recordings")
    assert loads("[server]\nruntime_dir = '/run/mine'").server.runtime_dir == "/run/mine"


def test_the_file_to_read_is_the_one_the_environment_names(monkeypatch: pytest.MonkeyPatch) -> None:
    assert default_path() == Path("/etc/robotd/robotd.toml")
    monkeypatch.setenv("ROBOTD_CONFIG", "/srv/robot.toml")
    assert default_path() == Path("/srv/robot.toml")


def test_a_device_has_the_options_of_its_dialect_alone() -> None:
    text = "[pantilt]\ndialect = 'dynamixel'\npan_id = 7\n[rangefinder]\ndialect = 'dimetix'\ndevice_id = 4\n"
    config = loads(text)
    assert isinstance(config.pantilt, DynamixelSettings)
    assert (config.pantilt.pan_id, config.pantilt.tilt_id) == (7, 2)
    assert isinstance(config.rangefinder, DimetixSettings)
    assert config.rangefinder.device_id == 4
    written = effective_text(config)
    assert loads(written) == config
    assert "telemetry_ms" in written.split("[pantilt]")[0]
    assert "telemetry_ms" not in written.split("[pantilt]")[1]


@pytest.mark.parametrize("dialect", ["board", "ptu", "dynamixel"])
def test_a_text_that_says_the_defaults_of_all_dialects_stays_valid(dialect: str) -> None:
    """As every configuration and every recording did before the dialects had options of their own."""
    text = (
        f"[pantilt]\ndialect = '{dialect}'\ntelemetry_ms = 40\nttl_max_ms = 30000\nsilence_s = 1.0\n"
        f"pan_id = 1\ntilt_id = 2\npan_min_rad = {-math.pi}\npan_max_rad = {math.pi}\n"
    )
    assert loads(text) == loads(f"[pantilt]\ndialect = '{dialect}'")
