"""``top``: the whole robot at a glance, as it goes."""

import argparse

from robotd.cli.connection import connect
from robotd.cli.exit_codes import OK
from robotd.cli.live import live
from robotd.cli.show.terminal import print_json
from robotd.cli.show.wording import as_json
from robotd.cli.verb import Verb


def _top(arguments: argparse.Namespace) -> int:
    if arguments.json:  # programs want it once, and come again
        with connect(arguments) as client:
            print_json(as_json(client.status()))
        return OK
    return live(arguments, with_map=False)


VERBS = (
    Verb(
        "top",
        "show mode, links, pose, mission, sweep and log as they change; keys stop and arm",
        "robotctl top",
        _top,
        asks_daemon=True,
    ),
)
