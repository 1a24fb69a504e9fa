"""``config init``, ``config check`` and ``config show``."""

import argparse
import dataclasses
import sys
import tomllib
from collections.abc import Sequence
from pathlib import Path

from robotd import config
from robotd.cli.exit_codes import BAD_CONFIG, OK
from robotd.cli.outputs import CONFIG_MARK, MADE_CONFIG, output_argument, write
from robotd.cli.plugged_in import Port, plugged_in
from robotd.cli.show.terminal import command_line, complain, err, out, print_json
from robotd.cli.verb import Verb
from robotd.config.starter import starter_text
from robotd.core.errors import ConfigError, RobotdError
from robotd.hardware.devices.dialects import DIALECTS, MOTORLESS, SCANNERS


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
        if said is None and arguments.probe is None:
            said = _asked(device, ports)
        if said is not None:
            port, _, dialect = said.partition(",")
            chosen[device] = {"port": port, "dialect": dialect or "board"}
    remarks = {} if arguments.probe is None else _probed(arguments.probe or [port.path for port in ports], chosen)
    for section, key, value in arguments.set:
        chosen.setdefault(section, {})[key] = value
    text = starter_text(f"{CONFIG_MARK} config init.", chosen, remarks)
    config.loads(text, str(arguments.file))
    write(arguments.file, text.encode())
    if arguments.json:
        print_json({"file": str(arguments.file), "ports": [dataclasses.asdict(port) for port in ports]})
    else:
        out().print(f"{arguments.file}: written; next: {command_line('robotctl', 'doctor', arguments.file)}")
    return OK


def _probed(ports: Sequence[str], chosen: dict[str, dict[str, object]]) -> dict[str, str]:
    """Ask on ports who is there, tell it, and choose who answered; return what to remark on devices.

    Raises:
        RobotdError: nobody answered.
    """
    from robotd.cli.who_answers import not_asked, who_answers  # noqa: PLC0415  # all adapters, which nothing else needs

    # A port that was named is somebody's already.
    answers = who_answers([port for port in ports if port not in {one["port"] for one in chosen.values()}])
    remarks: dict[str, str] = {}
    for port, found in answers.items():
        if isinstance(found, str):
            err().print(f"{port}: {found}")
            continue
        words = f"{found.device}, {' or '.join(found.dialects)}: {found.said}"
        if found.device in chosen:
            err().print(f"{port}: {words}; left out, for there is one at {chosen[found.device]['port']}")
            continue
        err().print(f"{port}: {words}")
        chosen[found.device] = {"port": port, "dialect": found.dialects[0]}
        if len(found.dialects) > 1:
            remarks[found.device] = f"It answers as {', '.join(found.dialects)} all do: say which it is."
    # A scanner turns its own beam: there is no head, and nothing will ever answer for one.
    if chosen.get("rangefinder", {}).get("dialect") in SCANNERS:
        chosen.setdefault("pantilt", {"dialect": MOTORLESS})
    if not chosen:
        said = " ".join(f"--{device} PORT,DIALECT" for device in DIALECTS)
        raise RobotdError(f"no device answered; say where they are, with {said}")
    for device in DIALECTS:
        if device not in chosen:
            why = f" ({said})" if (said := not_asked(device)) else ""
            remarks[device] = f"No {device} answered{why}. Until there is a section [{device}], its defaults hold."
            err().print(f"{device}: none answered{why}; if there is one, name it: --{device} PORT,DIALECT")
    return remarks


def _asked(device: str, ports: tuple[Port, ...]) -> str:
    """Ask where a device is plugged in and what it speaks.

    Raises:
        RobotdError: there is nobody to ask.
    """
    if not sys.stdin.isatty():
        there = ", ".join(port.path for port in ports) or "nothing"
        raise RobotdError(
            f"where is the {device}? Nobody can be asked here: say --{device} PORT[,DIALECT], or let all ports be"
            f" asked, with --probe; plugged in: {there}"
        )
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
        "--probe",
        nargs="*",
        metavar="PORT",
        help="ask on these ports (default: all that are plugged in) which device is there, and write down those that"
        " answer. The question is written to the port whatever is there: first unplug what is no part of the robot",
    )
    parser.add_argument(
        "--set", action="append", type=_setting, default=[], metavar="SECTION.KEY=VALUE", help="set something else, too"
    )


VERBS = (
    Verb(
        "config init",
        "make a first configuration: ask for the devices or on their ports, write a commented file for those found",
        "robotctl config init robotd.toml --probe --drive /dev/ttyUSB0 --pantilt /dev/ttyUSB1,ptu --set maps.keep=3",
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
