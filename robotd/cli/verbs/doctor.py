"""``doctor``: what this installation consists of, and what it can see."""

import argparse
import dataclasses
import importlib.util
import platform
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import zmq
from serial.tools import list_ports

import robotd
from robotd import __version__, config
from robotd.cli.checkup import Check, checks
from robotd.cli.exit_codes import FAILED, OK
from robotd.cli.show.terminal import command_line, print_json, print_pairs
from robotd.cli.verb import Verb
from robotd.core.errors import ConfigError
from robotd.grid import kernels

_ROOT = Path(robotd.__file__).parents[1]


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
            return f"{self.file}: not there; make one, with: {command_line('robotctl', 'config', 'init', self.file)}"
        return "\n".join(self.problems) or f"{self.file}: good"


@dataclass(frozen=True, slots=True)
class CompiledFound:
    """A library that was compiled at installation, or was not."""

    module: str
    found: bool
    newer_source: str | None
    """A file of its source that was changed since it was compiled; only a clone has them."""

    def __str__(self) -> str:
        """Return one line."""
        if not self.found:
            return "not compiled"
        if self.newer_source is None:
            return "compiled"
        again = command_line("pip", "install", "-e", _ROOT)
        return f"compiled from older source than {self.newer_source}: run {again}"


@dataclass(frozen=True, slots=True)
class Findings:
    """Everything that ``doctor`` looks at."""

    robotd: str
    python: str
    numpy: str
    pyzmq: str
    kernels: kernels.KernelsInUse
    compiled_kernels: CompiledFound
    compiled_boards: CompiledFound
    """The firmware of our own boards, for ``robotctl sim --boards c``."""
    plots: bool
    """Whether pictures can be drawn."""
    serial_ports: tuple[str, ...]
    config: ConfigFound
    checks: tuple[Check, ...]
    """What a daemon with this configuration needs of this machine; none where the configuration is not good."""

    def lines(self) -> list[tuple[str, object]]:
        """Return names and values for people."""
        plots = "yes" if self.plots else "no: pip install 'robotd[plots]'"
        ports = "\n".join(self.serial_ports) or "none to be seen"
        own = {"plots": plots, "serial ports": ports}
        checked: dict[str, object] = {check.what: check for check in self.checks}
        shown = {field.name.replace("_", " "): getattr(self, field.name) for field in dataclasses.fields(self)}
        del shown["checks"]
        return list((shown | own | checked).items())


def examine(file: Path | None = None) -> Findings:
    """Look at this installation and this machine, as a daemon with this configuration needs it."""
    found = _config(file or config.default_path())
    return Findings(
        robotd=__version__,
        python=f"{platform.python_version()} ({platform.machine()})",
        numpy=np.__version__,
        pyzmq=f"{zmq.pyzmq_version()} (libzmq {zmq.zmq_version()})",
        kernels=kernels.in_use().about,
        compiled_kernels=_compiled("robotd.grid.kernels._native", _ROOT / "robotd/grid/kernels"),
        compiled_boards=_compiled("robotd.sim.firmware._native", _ROOT / "firmware_proto/c"),
        # Looked for, not imported: to load it takes longer than all the rest of this.
        plots=importlib.util.find_spec("matplotlib") is not None,
        serial_ports=tuple(sorted(f"{port.device} {port.description}" for port in list_ports.comports())),
        config=found,
        checks=() if found.problems or not found.found else tuple(checks(config.load(Path(found.file)))),
    )


def _compiled(module: str, source: Path) -> CompiledFound:
    spec = importlib.util.find_spec(module)
    if spec is None or spec.origin is None:
        return CompiledFound(module, found=False, newer_source=None)
    if not (_ROOT / "setup.py").exists():  # a wheel: its files have the times at which they were unpacked
        return CompiledFound(module, found=True, newer_source=None)
    compiled_s = Path(spec.origin).stat().st_mtime
    changed = [file for file in sorted(source.rglob("*.[ch]")) if file.stat().st_mtime > compiled_s]
    return CompiledFound(module, found=True, newer_source=str(changed[0]) if changed else None)


def _config(file: Path) -> ConfigFound:
    if not file.exists():
        return ConfigFound(str(file), found=False, problems=())
    try:
        config.load(file)
    except ConfigError as error:
        return ConfigFound(str(file), found=True, problems=tuple(map(str, error.problems)))
    return ConfigFound(str(file), found=True, problems=())


def _doctor(arguments: argparse.Namespace) -> int:
    if arguments.file is not None:
        config.load(arguments.file)  # what was named must be one; without, what is missing is a finding
    findings = examine(arguments.file)
    if arguments.json:
        document: dict[str, Any] = dataclasses.asdict(findings)
        print_json(document)
    else:
        print_pairs(findings.lines())
    is_stale = findings.compiled_kernels.newer_source or findings.compiled_boards.newer_source
    is_ill = any(not check.is_well for check in findings.checks)
    return FAILED if findings.config.problems or is_stale or is_ill else OK


def _file(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "file", nargs="?", type=Path, help="a robotd.toml (default: $ROBOTD_CONFIG, or /etc/robotd/robotd.toml)"
    )


VERBS = (
    Verb(
        "doctor",
        "say what this installation consists of, which kernels it uses and why, and what it can see",
        "robotctl doctor /etc/robotd/robotd.toml",
        _doctor,
        _file,
    ),
)
