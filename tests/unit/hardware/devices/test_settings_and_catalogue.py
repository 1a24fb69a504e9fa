"""Settings of the devices, and which adapter they lead to."""

import pkgutil
import random
import typing
from typing import Any

import pytest

from robotd.contract.device_status import LinkState
from robotd.core.errors import ConfigError
from robotd.hardware import wire
from robotd.hardware.devices import catalogue, dialects
from robotd.hardware.devices.calibration import DriveCalibration, HeadMount, RangefinderCalibration
from robotd.hardware.devices.dialect_options import (
    BoardDriveSettings,
    BoardPanTiltSettings,
    BoardRangefinderSettings,
    DimetixSettings,
    DynamixelSettings,
    FixedHeadSettings,
    RflexSettings,
)
from robotd.hardware.devices.settings import DriveSettings, PanTiltSettings, RangefinderSettings
from robotd.hardware.devices.wiring import Wiring
from robotd.sim.buildings.world import load_world
from robotd.sim.emulators.catalogue import DRIVES, OWN, PANTILTS, RANGEFINDERS, Dialects
from robotd.sim.emulators.paced import Paced
from robotd.sim.robot import SimulatedRobot
from tests.support.taps import NoTap
from tests.unit.hardware.devices.conftest import nowhere

NAMES = [(device, name) for device, table in dialects.DIALECTS.items() for name in table]
SHARED = {"robotd.hardware.wire.enquiry", "robotd.hardware.wire.receiving", "robotd.hardware.wire.word"}
WIRING = Wiring(nowhere, NoTap(), random.Random(0))


def test_flat_settings_give_the_calibrations() -> None:
    assert DriveSettings(counts_per_m=1000.0, counts_per_rad=2000.0).calibration == DriveCalibration(1000.0, 2000.0)
    assert PanTiltSettings(x_m=0.1, y_m=0.2, pan_zero_rad=0.3, tilt_zero_rad=0.4).mount == HeadMount(0.1, 0.2, 0.3, 0.4)
    assert RangefinderSettings().calibration == RangefinderCalibration(0.0, 0.3, 6.0)


@pytest.mark.parametrize(
    ("kind", "values", "message"),
    [
        (DriveSettings, {"port": ""}, "port must not be empty"),
        (DriveSettings, {"line": "9600"}, "expected a speed and a frame as in '115200 8N1' or '19200 7E1', got '9600'"),
        (BoardDriveSettings, {"telemetry_ms": 1000}, "telemetry_ms must be 5 to 250 ms, got 1"),
        (RflexSettings, {"telemetry_ms": 200, "silence_s": 0.5}, "silence_s must be at least 3 times telemetry_ms"),
        (DynamixelSettings, {"pan_id": 2}, "tilt_id must differ from pan_id, got 2 twice"),
        (FixedHeadSettings, {"line": "9600 8N1"}, "line must be empty, for a fixed head has none"),
        (DimetixSettings, {"device_id": 10}, "device_id must be 0 to 9, got 10"),
        (BoardDriveSettings, {"ttl_max_ms": 70_000}, "ttl_max_ms must be 10 to 65535 ms, got 70000"),
        (DriveSettings, {"counts_per_m": 0.0}, "counts_per_m must be 100 to "),
        (PanTiltSettings, {"y_m": 20.0}, "y_m must be -3 to 3 m, got 20"),
        (RangefinderSettings, {"range_min_m": 7.0}, "range_max_m must be above range_min_m"),
    ],
)
def test_impossible_settings_are_refused_by_name(kind: Any, values: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        kind(**values)


def test_each_device_is_made_and_absent_at_first() -> None:
    devices = (
        catalogue.drive(BoardDriveSettings(), WIRING),
        catalogue.pantilt(BoardPanTiltSettings(), WIRING),
        catalogue.rangefinder(BoardRangefinderSettings(), WIRING),
    )
    assert [device.name for device in devices] == ["drive", "pantilt", "rangefinder"]
    assert {device.status.link for device in devices} == {LinkState.ABSENT}


def test_an_unknown_dialect_is_a_config_error_that_names_the_known_ones() -> None:
    with pytest.raises(ConfigError, match=r"drive\.dialect: no drive speaks 'klingon'; known: board"):
        catalogue.drive(DriveSettings(dialect="klingon"), WIRING)
    with pytest.raises(ConfigError, match=r"pantilt\.dialect"):
        catalogue.pantilt(PanTiltSettings(dialect="klingon"), WIRING)
    with pytest.raises(ConfigError, match=r"rangefinder\.dialect"):
        catalogue.rangefinder(RangefinderSettings(dialect="klingon"), WIRING)


def test_options_of_another_dialect_are_a_config_error() -> None:
    with pytest.raises(ConfigError, match="drive speaks 'rflex': expected RflexSettings, got BoardDriveSettings"):
        catalogue.drive(BoardDriveSettings(dialect="rflex"), WIRING)


@pytest.mark.parametrize(("device", "name"), NAMES)
def test_an_adapter_takes_the_options_of_its_dialect(device: str, name: str) -> None:
    adapter, options = catalogue.SPEAKERS[device][name].adapter, dialects.DIALECTS[device][name].options
    assert adapter(options(port="/dev/null", dialect=name), WIRING).name == device
    wanted = typing.get_type_hints(adapter.__init__)["settings"]
    assert issubclass(options, wanted)


@pytest.mark.parametrize(("device", "name"), NAMES)
def test_every_dialect_has_an_emulator_on_its_line(device: str, name: str) -> None:
    emulators = {"drive": DRIVES, "pantilt": PANTILTS, "rangefinder": RANGEFINDERS}[device]
    assert set(emulators) == set(dialects.DIALECTS[device])
    spoken: dict[str, Any] = {device: name}
    if name in {dialects.MOTORLESS, *dialects.SCANNERS}:
        spoken = {"pantilt": dialects.MOTORLESS, "rangefinder": dialects.SCANNERS[0]}
    robot = SimulatedRobot(load_world("office"), seed=1, dialects=Dialects(**spoken))
    has_line = dialects.DIALECTS[device][name].line is not None
    assert isinstance(robot.boards[device], Paced) == (has_line and name != OWN)


def test_what_a_configuration_may_name_is_spoken_and_the_other_way_round() -> None:
    known = {
        (device, name): row.line is not None for device, rows in dialects.DIALECTS.items() for name, row in rows.items()
    }
    spoken = {
        (device, name): row.speech is not None
        for device, rows in catalogue.SPEAKERS.items()
        for name, row in rows.items()
    }
    assert known == spoken


def test_every_wire_is_read_by_a_dialect() -> None:
    said = [row.speech for rows in catalogue.SPEAKERS.values() for row in rows.values() if row.speech is not None]
    modules = {speech.wire.__module__ for speech in said} | {speech.words.__module__ for speech in said}
    assert modules == {f"{wire.__name__}.{name}" for _, name, _ in pkgutil.iter_modules(wire.__path__)} - SHARED
