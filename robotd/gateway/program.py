"""``robotd-gateway``: read the settings, see that somebody can sign in, serve.

Exit codes: 0 ended by a signal, 1 failed, 2 wrong usage, 78 wrong configuration or no token.
"""

import argparse
import asyncio
import logging
import sys
from collections.abc import Sequence
from pathlib import Path

from robotd import __version__
from robotd.core.errors import ConfigError, RobotdError
from robotd.core.log import configure
from robotd.gateway.settings import DEFAULT_FILE, GatewaySettings
from robotd.toml.settings_reader import read_file, read_text

OK, FAILED, BAD_CONFIG = 0, 1, 78

log = logging.getLogger("robotd.gateway")


def read_settings(path: Path | None) -> GatewaySettings:
    """Return the settings of a file; without one, the system's, or the defaults where there is none.

    Raises:
        ConfigError: all that is wrong with them, each with file and line.
    """
    if path is None and not Path(DEFAULT_FILE).exists():
        return read_text(GatewaySettings, "", "defaults")
    return read_file(GatewaySettings, path or Path(DEFAULT_FILE))


def main(argv: Sequence[str] | None = None) -> int:
    """Run the gateway and return its exit code."""
    arguments = build_parser().parse_args(argv)
    configure(arguments.log_level)
    try:
        return _run(arguments)
    except ConfigError as error:
        for problem in error.problems:
            print(f"robotd-gateway: {problem}", file=sys.stderr)
        return BAD_CONFIG
    except RobotdError as error:
        print(f"robotd-gateway: {error}", file=sys.stderr)
        return FAILED


def build_parser() -> argparse.ArgumentParser:
    """Return what the program takes."""
    parser = argparse.ArgumentParser(prog="robotd-gateway", description="Serve the robot's console to browsers.")
    parser.add_argument("--config", type=Path, metavar="FILE", help=f"its settings (default: {DEFAULT_FILE})")
    parser.add_argument("--check", action="store_true", help="say whether the settings are right, and end")
    parser.add_argument("--log-level", default="info", choices=("debug", "info", "warning", "error"))
    parser.add_argument("-V", "--version", action="version", version=f"robotd-gateway {__version__}")
    return parser


def _run(arguments: argparse.Namespace) -> int:
    settings = read_settings(arguments.config)
    if arguments.check:
        print("robotd-gateway: the settings are right")
        return OK
    try:
        from robotd.gateway.composed import run  # noqa: PLC0415  # only here is the extra needed
    except ImportError as error:
        raise RobotdError(
            f"the gateway needs aiohttp ({error}): install the extra, pip install 'robotd[gateway]'"
        ) from error

    asyncio.run(run(settings, _ready))
    return OK


def _ready(address: str) -> None:
    log.info("the console is at %s", address)


if __name__ == "__main__":
    sys.exit(main())
