"""``config check`` and ``config show``."""

import argparse
import dataclasses
from pathlib import Path

from robotd import config
from robotd.cli.exit_codes import BAD_CONFIG, OK
from robotd.cli.show.terminal import complain, out, print_json
from robotd.cli.verb import Verb
from robotd.core.errors import ConfigError


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
    tree = config.load(arguments.file or config.default_path())
    if arguments.json:
        print_json(dataclasses.asdict(tree))
    else:
        out().print(config.effective_text(tree), end="")
    return OK


VERBS = (
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
