"""The directive ``robotctl``: the help of every verb, as the program itself prints it."""

import argparse
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from robotd.cli.main import WORDS, verbs_of

_WIDTH = 100


class Commands(SphinxDirective):
    """A section for each first word of the command line, a block for each verb."""

    def run(self) -> list[nodes.Node]:
        """Return the sections."""
        return [self._section(word) for word in WORDS]

    def _section(self, word: str) -> nodes.Node:
        section = nodes.section(ids=[f"robotctl-{word}"])
        section += nodes.title(text=word)
        for verb in verbs_of(word):
            parser = argparse.ArgumentParser(prog=f"robotctl {verb.name}", formatter_class=_formatter)
            verb.add_to(parser)
            section += nodes.literal_block(text=parser.format_help(), language="text")
        return section


def _formatter(prog: str) -> argparse.HelpFormatter:
    return argparse.RawDescriptionHelpFormatter(prog, width=_WIDTH)


def setup(app: Sphinx) -> dict[str, Any]:
    """Offer the directive."""
    app.add_directive("robotctl", Commands)
    return {"parallel_read_safe": True}
