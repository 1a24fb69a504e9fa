"""``schema``: the wire as JSON Schema, for programs in other languages. It needs no daemon."""

import argparse

from robotd.cli.exit_codes import OK
from robotd.cli.show.terminal import print_json
from robotd.cli.verb import Verb
from robotd.contract.json_schema import wire_schema


def _schema(_: argparse.Namespace) -> int:
    print_json(wire_schema())
    return OK


VERBS = (
    Verb(
        "schema",
        "print every request, reply and event as one JSON Schema, made from the types",
        "robotctl schema > robotd-v1.schema.json",
        _schema,
    ),
)
