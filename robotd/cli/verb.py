"""A verb of the command line as data: what it is called, what it takes, what it does."""

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from robotd.cli.exit_codes import FAILED, INTERRUPTED, OK, WRONG_USAGE
from robotd.cli.quantities import positive

_ALWAYS = ((OK, "done"), (FAILED, "failed"), (WRONG_USAGE, "wrong usage"))
_WITH_DAEMON = ((INTERRUPTED, "interrupted: the robot was stopped"),)


def no_arguments(_: argparse.ArgumentParser) -> None:
    """Take nothing beyond the common options."""


@dataclass(frozen=True, slots=True)
class Verb:
    """One verb; ``run`` returns the exit code."""

    name: str
    """As typed: ``status``, or ``map show`` for one of a family."""
    summary: str
    example: str
    """A whole command line that works."""
    run: Callable[[argparse.Namespace], int]
    arguments: Callable[[argparse.ArgumentParser], None] = no_arguments
    asks_daemon: bool = False
    """Whether it needs a running daemon: such verbs take ``--runtime-dir`` and ``--timeout``."""
    prints_json: bool = True
    """Whether it takes ``--json``, which prints its answer; a verb that also writes it to a file has its own."""
    exit_codes: tuple[tuple[int, str], ...] = ()
    """What it may return beside the usual, and what that means."""

    def add_to(self, parser: argparse.ArgumentParser) -> None:
        """Give a fresh parser all about this verb."""
        parser.description = f"{self.summary[:1].upper()}{self.summary[1:]}."
        codes = sorted((*_ALWAYS, *(_WITH_DAEMON if self.asks_daemon else ()), *self.exit_codes))
        said = ", ".join(f"{code} {meaning}" for code, meaning in codes)
        parser.epilog = f"Example: {self.example}\nExit codes: {said}"
        self.arguments(parser)
        if self.prints_json:
            parser.add_argument("--json", action="store_true", help="print JSON instead of text for people")
        if self.asks_daemon:
            parser.add_argument("--runtime-dir", type=Path, metavar="DIR", help="where the daemon has its sockets")
            parser.add_argument(
                "--timeout",
                type=positive,
                metavar="S",
                help="longest wait for an answer [s] (default: 10 to 60, by what is asked; 3 if no daemon is there)",
            )
        parser.set_defaults(run=self.run)
