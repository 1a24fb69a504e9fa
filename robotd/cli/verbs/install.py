"""``install``: units, rules, users, directories, a first configuration, manuals, where this machine looks."""

import argparse
import shutil
import stat
import sys
from pathlib import Path

from robotd.cli.exit_codes import OK
from robotd.cli.outputs import write
from robotd.cli.service_files import service_files, systemd_version
from robotd.cli.show.terminal import command_line, out, print_json, print_table
from robotd.cli.verb import Verb
from robotd.core.errors import RobotdError

_COMMANDS = Path("/usr/local/bin")
_NEXT = (
    "systemd-sysusers",
    "systemd-tmpfiles --create",
    "udevadm control --reload && udevadm trigger",
    "systemctl daemon-reload",
    "systemctl enable --now robotd",
)


def _install(arguments: argparse.Namespace) -> int:
    root, prefix = arguments.root.absolute(), arguments.prefix.absolute()
    _require_program(root / prefix.relative_to("/") / "bin" / "robotd", prefix)
    is_here = root == Path("/")
    files = tuple(service_files(prefix, root, systemd_version() if is_here else None))
    for file in files:
        if file.is_written and not arguments.dry_run:
            write(file.path, file.content)
    if arguments.json:
        print_json([{"file": str(file.path), "fate": file.fate} for file in files])
        return OK
    print_table(("file", "would be" if arguments.dry_run else "is"), [(str(file.path), file.fate) for file in files])
    if is_here and not arguments.dry_run:
        out().print(f"now, as root: {'; '.join((*linked(prefix), *_NEXT))}", markup=False)
    return OK


def linked(prefix: Path) -> tuple[str, ...]:
    """Return what makes the command line known to shells; nothing if they know one."""
    return () if shutil.which("robotctl") else (command_line("ln", "-s", prefix / "bin" / "robotctl", _COMMANDS),)


def _require_program(program: Path, prefix: Path) -> None:
    try:
        mode = program.stat().st_mode
    except PermissionError as error:
        raise RobotdError(f"{program}: {error.strerror}") from error
    except OSError:
        mode = 0
    if not mode & stat.S_IXUSR:
        raise RobotdError(
            f"{program}: there is no such program; first: python3 -m venv {prefix}, then {prefix}/bin/pip install"
            " robotd, or say with --prefix where it is"
        )


def _arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--prefix",
        type=Path,
        default=Path(sys.prefix),
        metavar="DIR",
        help="the virtual environment with the program (default: the one that this is of)",
    )
    parser.add_argument(
        "--root", type=Path, default=Path("/"), metavar="DIR", help="what stands for / (default: / itself)"
    )
    parser.add_argument("--dry-run", action="store_true", help="say what would become of each file, and write nothing")


VERBS = (
    Verb(
        "install",
        "put unit, rules, user, configuration, manuals and completions where they belong; what you changed is kept",
        "robotctl install --prefix /opt/robotd --dry-run",
        _install,
        _arguments,
    ),
)
