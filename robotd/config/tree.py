"""The whole configuration: every room's settings under one roof."""

import os
from dataclasses import dataclass, field
from pathlib import PurePath
from typing import Annotated

from robotd.config.environment import runtime_dir
from robotd.config.sections import MapsSettings, RecordingSettings
from robotd.core.errors import ConfigError
from robotd.grid.settings import GridSettings
from robotd.hardware.devices.dialect_options import BoardDriveSettings, BoardPanTiltSettings, BoardRangefinderSettings
from robotd.hardware.devices.dialects import DIALECTS, MOTORLESS, SCANNERS, line_format
from robotd.hardware.devices.settings import (
    BoardOptions,
    DriveSettings,
    PanTiltSettings,
    PortSettings,
    RangefinderSettings,
    ReportOptions,
)
from robotd.hardware.devices.slant import slanted_beam
from robotd.hardware.transport.address import host_and_port
from robotd.localization.fit.refinement_settings import RefinementSettings
from robotd.localization.judge.error_model import ErrorModel
from robotd.localization.judge.judgement import Judgement
from robotd.localization.judge.second_look_settings import SecondLookSettings
from robotd.localization.settings import LocalizationSettings
from robotd.mission.missions.sweep_settings import SweepSettings
from robotd.mission.motion.steering import DrivingSettings
from robotd.planning.settings import PlanningSettings
from robotd.server.settings import ServerSettings
from robotd.toml.chosen import ChosenBy


def _by_dialect(device: str) -> ChosenBy:
    """Return how the section of a device is chosen: each dialect has options of its own."""
    return ChosenBy("dialect", {name: dialect.options for name, dialect in DIALECTS[device].items()})


@dataclass(frozen=True, slots=True)
class Config:
    """What ``robotd.toml`` says; each field is a section."""

    server: ServerSettings = field(default_factory=lambda: ServerSettings(runtime_dir=runtime_dir()))
    drive: Annotated[DriveSettings, _by_dialect("drive")] = field(default_factory=BoardDriveSettings)
    pantilt: Annotated[PanTiltSettings, _by_dialect("pantilt")] = field(default_factory=BoardPanTiltSettings)
    rangefinder: Annotated[RangefinderSettings, _by_dialect("rangefinder")] = field(
        default_factory=BoardRangefinderSettings
    )
    sweep: SweepSettings = field(default_factory=SweepSettings)
    driving: DrivingSettings = field(default_factory=DrivingSettings)
    grid: GridSettings = field(default_factory=GridSettings)
    localization: LocalizationSettings = field(default_factory=LocalizationSettings)
    refinement: RefinementSettings = field(default_factory=RefinementSettings)
    second_look: SecondLookSettings = field(default_factory=SecondLookSettings)
    error_model: ErrorModel = field(default_factory=ErrorModel)
    planning: PlanningSettings = field(default_factory=PlanningSettings)
    maps: MapsSettings = field(default_factory=MapsSettings)
    recording: RecordingSettings = field(default_factory=RecordingSettings)

    def __post_init__(self) -> None:
        """Refuse sections that contradict each other."""
        for device, settings in self.devices.items():
            _check_device(device, settings)
        _check_ports_differ(self.devices)
        _check_head(self.pantilt, self.rangefinder)
        _check_floor(self.pantilt, self.sweep, self.rangefinder)
        _check_motion(self.drive, self.driving)
        _check_places(self.maps, self.recording)
        _check_cells(self.grid, self.planning)

    @property
    def judgement(self) -> Judgement:
        """How poses of high rank are judged."""
        return Judgement(self.refinement, self.second_look)

    @property
    def devices(self) -> dict[str, PortSettings]:
        """The three devices by name."""
        return {"drive": self.drive, "pantilt": self.pantilt, "rangefinder": self.rangefinder}


def _check_device(device: str, settings: PortSettings) -> None:
    if settings.dialect not in DIALECTS[device]:
        known = ", ".join(DIALECTS[device])
        raise ValueError(f'{device}.dialect must be one of {known}; got "{settings.dialect}"')
    try:
        if line_format(device, settings) is not None:
            host_and_port(settings.port)
    except ConfigError as error:
        raise ValueError(f'{device}.port must be a device path or tcp://host:port, got "{settings.port}"') from error


def _check_ports_differ(devices: dict[str, PortSettings]) -> None:
    owners: dict[str, str] = {}
    # What has no line of its own has a port in name alone.
    with_lines = {name: settings for name, settings in devices.items() if line_format(name, settings) is not None}
    for device, settings in with_lines.items():
        owner = owners.setdefault(settings.port, device)
        if owner != device:
            raise ValueError(f"{device}.port must not be the port of another device, got {owner}.port")


def _check_head(pantilt: PanTiltSettings, rangefinder: RangefinderSettings) -> None:
    if (pantilt.dialect == MOTORLESS) != (rangefinder.dialect in SCANNERS):
        raise ValueError(
            f'pantilt.dialect must be "{MOTORLESS}" if rangefinder.dialect is a scanner ({", ".join(SCANNERS)}),'
            f' and only then; got "{pantilt.dialect}" and "{rangefinder.dialect}"'
        )


def _check_floor(pantilt: PanTiltSettings, sweep: SweepSettings, rangefinder: RangefinderSettings) -> None:
    """Refuse a slant whose beams meet the floor where they are believed: it would be taken for walls all round."""
    floor_m = slanted_beam(pantilt.mount, 0.0, sweep.tilt_rad).floor_m
    if floor_m <= rangefinder.range_max_m:
        raise ValueError(
            f"sweep.tilt_rad must be such that the beam meets the floor beyond rangefinder.range_max_m, got"
            f" {sweep.tilt_rad} rad, at which it does at {floor_m:.2f} m, and {rangefinder.range_max_m} m"
        )


def _check_motion(drive: DriveSettings, driving: DrivingSettings) -> None:
    if isinstance(drive, BoardOptions) and driving.setpoint_ttl_s * 1000.0 > drive.ttl_max_ms:
        raise ValueError(
            f"driving.setpoint_ttl_s must be within drive.ttl_max_ms, got {driving.setpoint_ttl_s} s"
            f" and {drive.ttl_max_ms} ms"
        )
    if isinstance(drive, ReportOptions):  # set-points follow the reports
        _check_paced(drive.telemetry_ms, driving)
    if driving.setpoint_ttl_s > driving.silence_s:  # the base must not drive on for longer than it may be silent
        raise ValueError(
            f"driving.setpoint_ttl_s must be no longer than driving.silence_s, got {driving.setpoint_ttl_s} s"
            f" and {driving.silence_s} s"
        )


def _check_paced(telemetry_ms: int, driving: DrivingSettings) -> None:
    for name in ("setpoint_ttl_s", "silence_s"):
        seconds = getattr(driving, name)
        if seconds * 1000.0 <= telemetry_ms:
            raise ValueError(
                f"driving.{name} must be longer than drive.telemetry_ms, got {seconds} s and {telemetry_ms} ms"
            )


def _check_cells(grid: GridSettings, planning: PlanningSettings) -> None:
    if grid.resolution_m > 2.0 * planning.robot_radius_m:
        raise ValueError(
            f"grid.resolution_m must be no more than twice planning.robot_radius_m, or no robot fits between"
            f" obstacles, got {grid.resolution_m} m and {planning.robot_radius_m} m"
        )


def _check_places(maps: MapsSettings, recording: RecordingSettings) -> None:
    # By name alone, links not followed: a replay reads the configuration of another machine.
    kept, recorded = (PurePath(os.path.normpath(section.dir)) for section in (maps, recording))
    if kept.is_relative_to(recorded) or recorded.is_relative_to(kept):
        raise ValueError(
            "recording.dir must not be maps.dir, nor lie in it, nor the other way round;"
            f' got "{recording.dir}" and "{maps.dir}"'
        )
