"""What a wheel brings for a system's ``share``: manual pages and completions, ``shared.py DIRECTORY``.

Both are made from the programs' own parsers; completions by shtab.
"""

import argparse
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

import shtab

from robotd import __version__
from robotd.app.daemon import build_parser as daemon_parser
from robotd.cli.main import build_parser, whole_parser
from robotd.gateway.program import build_parser as gateway_parser

SCRIPTS = {"bash": "bash-completion/completions/{}", "zsh": "zsh/site-functions/_{}"}
"""Shells, and where each of them looks for what it completes."""


def manual(program: argparse.ArgumentParser, verbs: Iterable[tuple[str, argparse.ArgumentParser]] = ()) -> str:
    """Return the manual page of a program, in the language of man: a section for each of its verbs."""
    name, does = program.prog, (program.description or "").removesuffix(".")
    text = [
        f'.TH {name.upper()} 1 "" "robotd {__version__}" "User Commands"',
        ".SH NAME",
        f"{name} \\- {_escaped(does[:1].lower() + does[1:])}",
        ".SH SYNOPSIS",
        *_literal(program.format_help()),
    ]
    for verb, parser in verbs:
        text += [f'.SH "{verb.upper()}"', *_literal(parser.format_help())]
    return "\n".join(text) + "\n"


def completion(program: argparse.ArgumentParser, shell: str) -> str:
    """Return what a shell completes of a program's words, options, choices and files."""
    for parser in _all_within(program):
        for action in parser._actions:  # noqa: SLF001  # no other way
            if action.type is Path or action.metavar == "FILE":
                action.complete = shtab.FILE  # type: ignore[attr-defined]  # shtab reads it, argparse lets it be
    text: str = shtab.complete(program, shell=shell)
    return text


def _all_within(parser: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    yield parser
    for action in parser._actions:  # noqa: SLF001  # no other way
        if isinstance(action, argparse._SubParsersAction):  # noqa: SLF001  # no other way
            for inner in action.choices.values():
                yield from _all_within(inner)


def _literal(block: str) -> list[str]:
    """Return lines as they are."""
    return [".nf", *(f"\\&{_escaped(line)}" for line in block.splitlines()), ".fi"]


def _escaped(text: str) -> str:
    return text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")


def shared() -> Iterator[tuple[str, str]]:
    """Yield every file, its place below ``share`` and its text."""
    (_, robotctl), *verbs = whole_parser()
    for program, its_verbs in ((robotctl, verbs), (daemon_parser(), ()), (gateway_parser(), ())):
        yield f"man/man1/{program.prog}.1", manual(program, its_verbs)
    for program in (build_parser((), knows_all=True), daemon_parser(), gateway_parser()):
        yield from ((place.format(program.prog), completion(program, shell)) for shell, place in SCRIPTS.items())


def main(directory: Path) -> None:
    """Write them."""
    for place, text in shared():
        path = directory / place
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
