"""The daemon, from the command line."""

import argparse

from robotd.server.client import Client


def connect(arguments: argparse.Namespace) -> Client:
    """Return a client of the daemon that ``--runtime-dir`` names; use it in a ``with`` block."""
    return Client(arguments.runtime_dir, deadline_s=arguments.timeout)
