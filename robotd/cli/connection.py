"""The daemon, from the command line."""

import argparse
import contextlib
import os
import socket
from pathlib import Path
from typing import TYPE_CHECKING

from robotd.core.endpoints import Endpoints, runtime_dir_of_user
from robotd.core.errors import TransportError

if TYPE_CHECKING:
    from robotd.client import Client


def connect(arguments: argparse.Namespace) -> "Client":
    """Return a client of the daemon that ``--runtime-dir`` names; use it in a ``with`` block.

    Raises:
        TransportError: there is no daemon, or this user may not talk to it.
    """
    directory = Path(arguments.runtime_dir or runtime_dir_of_user())
    # Told apart: without the right to enter, the socket seems not to be there.
    if directory.exists() and not os.access(directory, os.X_OK):
        raise TransportError(
            f"{directory}: permission denied: only members of its group may talk to robotd;"
            " join it, with: sudo usermod -aG robotd $USER, then log in again"
        )
    # Asked plainly and at once: a client waits for seconds, as a daemon may be about to start.
    require_daemon(directory)
    from robotd.client import Client  # noqa: PLC0415  # where there is no daemon, nobody waits for its client

    return Client(directory, deadline_s=arguments.timeout)


def require_daemon(directory: Path) -> None:
    """Return if somebody serves there.

    Raises:
        TransportError: nobody does; says what to start or set.
    """
    path = Endpoints(directory).paths[0]
    with contextlib.closing(socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)) as probe:
        probe.setblocking(False)
        try:
            probe.connect(str(path))
        except BlockingIOError:
            return  # its queue is full: somebody is there
        except OSError as error:
            why = (
                "there is no socket" if isinstance(error, FileNotFoundError) else (error.strerror or str(error)).lower()
            )
            raise TransportError(
                f"no daemon in {directory} ({why}): start one, with: systemctl start robotd, or robotd --config FILE;"
                " or say where its sockets are, with --runtime-dir or ROBOTD_RUNTIME_DIR"
            ) from error
