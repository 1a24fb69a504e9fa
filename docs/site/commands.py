"""The directive ``robotctl``: the help of every verb, as the program itself prints it."""

import argparse
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from robotd.cli.main import whole_parser

_WIDTH = 100


class Commands(SphinxDirective):
    """A section for each verb."""

    def run(self) -> list[nodes.Node]:
        """Return the sections, the program's own first."""
        return [self._section(name, parser) for name, parser in whole_parser()]

    def _section(self, name: str, parser: argparse.ArgumentParser) -> nodes.Node:
        parser.formatter_class = _formatter
        section = nodes.section(ids=[f"command-{name.replace(' ', '-')}"])
        section += nodes.title(text=name)
        section += nodes.literal_block(text=parser.format_help(), language="text")
        return section


def _formatter(prog: str) -> argparse.HelpFormatter:
    return argparse.RawDescriptionHelpFormatter(prog, width=_WIDTH)


def setup(app: Sphinx) -> dict[str, Any]:
    """Offer the directive."""
    app.add_directive("robotctl", Commands)
    return {"parallel_read_safe": True}
