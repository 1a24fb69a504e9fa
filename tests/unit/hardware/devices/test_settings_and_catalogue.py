"""Settings of the devices, and which adapter they lead to."""

import random
from typing import Any

import pytest

from robotd.contract.device_status import LinkState
from robotd.core.errors import ConfigError
from robotd.hardware.devices import catalogue
from robotd.hardware.devices.calibration import DriveCalibration, HeadMount, RangefinderCalibration
from robotd.hardware.devices.settings import DriveSettings, PanTiltSettings, RangefinderSettings
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.link.tap import NoTap
from tests.unit.hardware.devices.conftest import nowhere

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
        (DriveSettings, {"telemetry_ms": 1000}, "telemetry_ms must be 5 to 250 ms, got 1"),
        (DriveSettings, {"ttl_max_ms": 70_000}, "ttl_max_ms must be 10 to 65535 ms, got 70000"),
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
        catalogue.drive(DriveSettings(), WIRING),
        catalogue.pantilt(PanTiltSettings(), WIRING),
        catalogue.rangefinder(RangefinderSettings(), WIRING),
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
