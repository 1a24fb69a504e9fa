"""What goes to the terminal: answers to standard output, everything else to standard error.

Every console is made here, and writes words as they are: ``[mm]`` is a unit, and names come from files and boards.
"""

import json
import shlex
import sys
from collections.abc import Iterable
from typing import Any, TextIO

from rich.console import Console
from rich.table import Table
from rich.text import Text

from robotd.cli.show.printable_console import PrintableOnly

_UNBROKEN = 10_000
"""Columns of a pipe: tables are not folded there, so that a line stays a line."""


def print_json(document: Any) -> None:
    """Print one JSON document on one line, at once."""
    print(json.dumps(document, allow_nan=False), flush=True)


def out() -> Console:
    """Return the console for answers; no colour and no width where there is no terminal, no colour with NO_COLOR."""
    return plain_console(sys.stdout, None if sys.stdout.isatty() else _UNBROKEN)


def err() -> Console:
    """Return the console for progress and complaints."""
    return plain_console(sys.stderr)


def plain_console(file: TextIO, width: int | None = None) -> Console:
    """Return a console that takes nothing for markup or control; it folds at a width, or if None at the terminal's."""
    console = Console(file=file, width=width, markup=False, emoji=False, highlight=False, soft_wrap=True)
    console.push_render_hook(PrintableOnly())
    return console


def command_line(*words: object) -> str:
    """Return a command to be copied into a shell, whatever its words hold.

    >>> command_line("robotctl", "replay", "my robot/a.mcap")
    "robotctl replay 'my robot/a.mcap'"
    """
    return shlex.join(map(str, words))


def bold(text: str) -> Text:
    """Return words that stand out."""
    return Text.assemble((text, "bold"))


def complain(message: str) -> None:
    """Print one line to standard error, as it is."""
    err().print(message, style="red")


def print_pairs(pairs: Iterable[tuple[str, object]]) -> None:
    """Print names and values in two columns."""
    grid = Table.grid(padding=(0, 2))
    grid.add_column(style="dim")
    grid.add_column()
    for name, value in pairs:
        grid.add_row(name, Text(str(value)))
    out().print(grid)


def print_table(columns: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
    """Print a table with a header."""
    table = Table(*columns, box=None, header_style="bold", pad_edge=False)
    for row in rows:
        table.add_row(*(Text(str(cell)) for cell in row))
    out().print(table)
