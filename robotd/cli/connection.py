"""The daemon, from the command line."""

import argparse
import os
from pathlib import Path

from robotd.client import Client
from robotd.core.endpoints import runtime_dir_of_user
from robotd.core.errors import TransportError


def connect(arguments: argparse.Namespace) -> Client:
    """Return a client of the daemon that ``--runtime-dir`` names; use it in a ``with`` block.

    Raises:
        TransportError: this user may not talk to the daemon there.
    """
    directory = Path(arguments.runtime_dir or runtime_dir_of_user())
    if directory.exists() and not os.access(directory, os.X_OK):
        raise TransportError(f"{directory}: permission denied: only members of its group may talk to robotd")
    return Client(directory, deadline_s=arguments.timeout)
