"""What a shell completes of robotctl's words, options, choices and files: ``completions.py bash|zsh``, by shtab."""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import shtab

from robotd.cli.main import build_parser


def parsers(parser: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    """Yield a parser and all those within it."""
    yield parser
    for action in parser._actions:  # noqa: SLF001  # no other way
        if isinstance(action, argparse._SubParsersAction):  # noqa: SLF001  # no other way
            for inner in action.choices.values():
                yield from parsers(inner)


def script(shell: str) -> str:
    """Return the script for a shell."""
    whole = build_parser((), knows_all=True)
    for parser in parsers(whole):
        for action in parser._actions:  # noqa: SLF001  # no other way
            if action.type is Path or action.metavar == "FILE":
                action.complete = shtab.FILE  # type: ignore[attr-defined]  # shtab reads it, argparse lets it be
    text: str = shtab.complete(whole, shell=shell)
    return text


if __name__ == "__main__":
    print(script(sys.argv[1]))
