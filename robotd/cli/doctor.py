"""``doctor``: what this installation consists of, and what it can see."""

import argparse
import dataclasses
import importlib.util
import platform
from dataclasses import dataclass
from typing import Any

import numpy as np
import zmq
from serial.tools import list_ports

from robotd import __version__, config
from robotd.cli.terminal import print_json, print_pairs
from robotd.cli.verb import FAILED, OK, Verb
from robotd.core.errors import ConfigError
from robotd.grid import kernels


@dataclass(frozen=True, slots=True)
class ConfigFound:
    """The configuration that the daemon would read."""

    file: str
    found: bool
    problems: tuple[str, ...]
    """Empty if there is nothing wrong with it."""

    def __str__(self) -> str:
        """Return one line, or one for each problem."""
        if not self.found:
            return f"{self.file}: not there; robotd needs one, or --config"
        return "\n".join(self.problems) or f"{self.file}: good"


@dataclass(frozen=True, slots=True)
class Findings:
    """Everything that ``doctor`` looks at."""

    robotd: str
    python: str
    numpy: str
    pyzmq: str
    kernels: kernels.KernelsInUse
    plots: bool
    """Whether pictures can be drawn."""
    serial_ports: tuple[str, ...]
    config: ConfigFound

    def lines(self) -> list[tuple[str, object]]:
        """Return names and values for people."""
        plots = "yes" if self.plots else "no: pip install 'robotd[plots]'"
        ports = "\n".join(self.serial_ports) or "none to be seen"
        own = {"plots": plots, "serial ports": ports}
        shown = {field.name.replace("_", " "): getattr(self, field.name) for field in dataclasses.fields(self)}
        return list((shown | own).items())


def examine() -> Findings:
    """Look at this installation and this machine."""
    return Findings(
        robotd=__version__,
        python=f"{platform.python_version()} ({platform.machine()})",
        numpy=np.__version__,
        pyzmq=f"{zmq.pyzmq_version()} (libzmq {zmq.zmq_version()})",
        kernels=kernels.IN_USE,
        plots=importlib.util.find_spec("matplotlib") is not None,
        serial_ports=tuple(sorted(f"{port.device} {port.description}" for port in list_ports.comports())),
        config=_config(),
    )


def _config() -> ConfigFound:
    file = config.default_path()
    if not file.exists():
        return ConfigFound(str(file), found=False, problems=())
    try:
        config.load(file)
    except ConfigError as error:
        return ConfigFound(str(file), found=True, problems=tuple(map(str, error.problems)))
    return ConfigFound(str(file), found=True, problems=())


def _doctor(arguments: argparse.Namespace) -> int:
    findings = examine()
    if arguments.json:
        document: dict[str, Any] = dataclasses.asdict(findings)
        print_json(document)
    else:
        print_pairs(findings.lines())
    return FAILED if findings.config.problems else OK


VERBS = (
    Verb(
        "doctor",
        "say what this installation consists of, which kernels it uses and why, and what it can see",
        "robotctl doctor",
        _doctor,
    ),
)
