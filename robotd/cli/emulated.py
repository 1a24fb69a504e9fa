"""What a daemon needs to know about a simulated robot, as a configuration file."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from robotd.cli.outputs import CONFIG_MARK, write
from robotd.config import Config, effective_text, loads
from robotd.recording.reader import Recording
from robotd.toml.writer import write_value

RUNTIME_DIR, MAPS_DIR, RECORDINGS_DIR = "run", "maps", "recordings"


def config_text(ports: Mapping[str, str], devices: Mapping[str, Mapping[str, object]] | None = None) -> str:
    """Return a configuration for devices on these ports, which keeps all that it makes beside itself.

    ``devices`` says what else the section of each device must hold.
    """
    sections: dict[str, dict[str, object]] = {
        "server": {"runtime_dir": RUNTIME_DIR},
        "maps": {"dir": MAPS_DIR},
        "recording": {"dir": RECORDINGS_DIR},
        **{device: {"port": port, **(devices or {}).get(device, {})} for device, port in ports.items()},
    }
    lines = [f"{CONFIG_MARK} for emulated devices; what is not here has its default."]
    for section, values in sections.items():
        lines += ["", f"[{section}]", *(f"{key} = {write_value(value)}" for key, value in values.items())]
    return "\n".join(lines) + "\n"


def recorded_config_text(ports: Mapping[str, str], recording: Recording) -> str:
    """Return the configuration of a recording, for devices on these ports, keeping all that it makes beside itself.

    Raises:
        ConfigError: it is not one of this version.
    """
    config = _recorded_config(recording)
    wired = replace(
        config,
        server=replace(config.server, runtime_dir=RUNTIME_DIR),
        maps=replace(config.maps, dir=MAPS_DIR),
        recording=replace(config.recording, dir=RECORDINGS_DIR),
        drive=replace(config.drive, port=ports["drive"]),
        pantilt=replace(config.pantilt, port=ports["pantilt"]),
        rangefinder=replace(config.rangefinder, port=ports["rangefinder"]),
    )
    return f"{CONFIG_MARK}: the configuration of the recorded robot, for its fake.\n\n" + effective_text(wired)


def recorded_dialects(recording: Recording) -> dict[str, str]:
    """Return what each device of a recorded robot speaks; ConfigError if its configuration is not of this version."""
    return {device: settings.dialect for device, settings in _recorded_config(recording).devices.items()}


def _recorded_config(recording: Recording) -> Config:
    return loads(recording.header.config_text, file="the recording's configuration")


def write_config(file: Path, text: str) -> None:
    """Write a configuration where there may not even be a directory yet.

    Raises:
        RobotdError: it cannot be written.
    """
    write(file, text.encode())
