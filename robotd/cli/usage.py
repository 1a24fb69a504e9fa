"""Wrong usage: said by the verb that was meant, with the option that was meant."""

import argparse
from collections.abc import Iterable, Sequence
from typing import Any, NoReturn

from robotd.cli.exit_codes import WRONG_USAGE


class WrongUsage(SystemExit):
    """A command line that cannot be meant; it ends the program as argparse would."""

    def __init__(self, parser: argparse.ArgumentParser, message: str) -> None:
        super().__init__(WRONG_USAGE)
        self.usage, self._message = parser.format_usage(), f"{parser.prog}: error: {message}"

    def __str__(self) -> str:
        """Say what is wrong, and of which verb."""
        return self._message


class Parser(argparse.ArgumentParser):
    """A parser whose errors can be told in more than one way, and that knows what was nearly typed."""

    def error(self, message: str) -> NoReturn:
        """Raise what is wrong with the command line."""
        raise WrongUsage(self, message)

    def parse_known_args(self, args: Sequence[str] | None = None, namespace: Any = None) -> Any:  # type: ignore[override]  # it has overloads
        """Refuse what is left over here, where options are known: argparse leaves that to the program as a whole."""
        found, left = super().parse_known_args(args, namespace)
        if left:
            options = [option for action in self._actions for option in action.option_strings]
            hint = nearest(left[0].partition("=")[0], options)
            self.error(f"{left[0]} means nothing here{hint} ({self.prog} --help lists what does)")
        return found, left


def nearest(typed: str, known: Iterable[str]) -> str:
    """Return what was likely meant, as a question; nothing if nothing is near.

    >>> nearest("stauts", ("arm", "status"))
    '; did you mean status?'
    """
    import difflib  # noqa: PLC0415  # only here; it takes longer to load than the rest

    near = difflib.get_close_matches(typed, known, n=1)
    return f"; did you mean {near[0]}?" if near else ""
