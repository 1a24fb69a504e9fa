"""``config init``, ``config check`` and ``config show``."""

import argparse
import dataclasses
import sys
import tomllib
from pathlib import Path

from robotd import config
from robotd.cli.exit_codes import BAD_CONFIG, OK
from robotd.cli.outputs import CONFIG_MARK, MADE_CONFIG, output_argument, write
from robotd.cli.plugged_in import Port, plugged_in
from robotd.cli.show.terminal import command_line, complain, err, out, print_json
from robotd.cli.verb import Verb
from robotd.config.starter import starter_text
from robotd.core.errors import ConfigError, RobotdError
from robotd.hardware.devices.catalogue import DIALECTS


def _file_argument(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "file", nargs="?", type=Path, help="a robotd.toml (default: $ROBOTD_CONFIG, or /etc/robotd/robotd.toml)"
    )


def _check(arguments: argparse.Namespace) -> int:
    file = arguments.file or config.default_path()
    try:
        config.load(file)
    except ConfigError as error:
        if not arguments.json:
            for problem in error.problems:
                complain(str(problem))
            return BAD_CONFIG
        print_json({"file": str(file), "ok": False, "problems": [_plain(problem) for problem in error.problems]})
        return BAD_CONFIG
    if arguments.json:
        print_json({"file": str(file), "ok": True, "problems": []})
    else:
        out().print(f"{file}: good")
    return OK


def _plain(problem: ConfigError) -> dict[str, object]:
    return {"file": problem.file, "line": problem.line, "key": problem.key, "message": problem.message}


def _show(arguments: argparse.Namespace) -> int:
    file = arguments.file or config.default_path()
    # Without any, what a daemon would run with is what is of interest: the defaults.
    tree = config.load(file) if arguments.file is not None or file.exists() else config.Config()
    if arguments.json:
        print_json(dataclasses.asdict(tree))
    else:
        out().print(config.effective_text(tree), end="")
    return OK


def _init(arguments: argparse.Namespace) -> int:
    """Ask for what was not said, and write the file, which must be a good one."""
    ports = plugged_in()
    chosen: dict[str, dict[str, object]] = {}
    for device in DIALECTS:
        said = getattr(arguments, device)
        if said is None:
            said = _asked(device, ports)
        port, _, dialect = said.partition(",")
        chosen[device] = {"port": port, "dialect": dialect or "board"}
    for section, key, value in arguments.set:
        chosen.setdefault(section, {})[key] = value
    text = starter_text(f"{CONFIG_MARK} config init.", chosen)
    config.loads(text, str(arguments.file))
    write(arguments.file, text.encode())
    if arguments.json:
        print_json({"file": str(arguments.file), "ports": [dataclasses.asdict(port) for port in ports]})
    else:
        out().print(f"{arguments.file}: written; next: {command_line('robotctl', 'doctor', arguments.file)}")
    return OK


def _asked(device: str, ports: tuple[Port, ...]) -> str:
    """Ask where a device is plugged in and what it speaks.

    Raises:
        RobotdError: there is nobody to ask.
    """
    if not sys.stdin.isatty():
        raise RobotdError(f"where is the {device}? Say so with --{device} PORT[,DIALECT] where nobody can be asked")
    for number, port in enumerate(ports, 1):
        err().print(f"  {number}  {port.path}  {port.about}")
    err().print(f"{device}: which of these, or a path, or tcp://host:port? ", end="")
    typed = sys.stdin.readline().strip()
    path = ports[int(typed) - 1].path if typed.isdecimal() and 0 < int(typed) <= len(ports) else typed
    err().print(f"{device}: what does it speak? {', '.join(DIALECTS[device])} [board] ", end="")
    return f"{path},{sys.stdin.readline().strip()}"


def _setting(text: str) -> tuple[str, str, object]:
    """Read ``SECTION.KEY=VALUE``, the value as TOML has it; what is none is a text."""
    name, equals, value = text.partition("=")
    section, dot, key = name.strip().partition(".")
    if not (equals and dot and section and key):
        raise argparse.ArgumentTypeError(f"expected SECTION.KEY=VALUE, got {text!r}")
    try:
        return section, key, tomllib.loads(f"x = {value}")["x"]
    except tomllib.TOMLDecodeError:
        return section, key, value


def _init_arguments(parser: argparse.ArgumentParser) -> None:
    output_argument(parser, "file", MADE_CONFIG, "where to write it")
    for device in DIALECTS:
        parser.add_argument(
            f"--{device}", metavar="PORT[,DIALECT]", help=f"where the {device} is, and what it speaks (default: asked)"
        )
    parser.add_argument(
        "--set", action="append", type=_setting, default=[], metavar="SECTION.KEY=VALUE", help="set something else, too"
    )


VERBS = (
    Verb(
        "config init",
        "make a first configuration: ask for the devices, list what is plugged in, write a commented file",
        "robotctl config init robotd.toml --drive /dev/ttyUSB0 --pantilt /dev/ttyUSB1,ptu --set maps.keep=3",
        _init,
        _init_arguments,
    ),
    Verb(
        "config check",
        "say all that is wrong with a configuration, one line each",
        "robotctl config check /etc/robotd/robotd.toml",
        _check,
        _file_argument,
    ),
    Verb(
        "config show",
        "print the effective configuration: the file, and the default of everything it leaves out",
        "robotctl config show > full.toml",
        _show,
        _file_argument,
    ),
)
