"""Where the sockets are."""

import os
from dataclasses import dataclass
from pathlib import Path

from robotd.core.errors import TransportError

DEFAULT_RUNTIME_DIR = "/run/robotd"
_LONGEST_PATH = 107
"""What fits into ``sun_path`` of a Unix socket's address, less its final zero."""


def runtime_dir_of_user() -> str:
    """Return the runtime directory a client looks in: ``ROBOTD_RUNTIME_DIR``, or the system's."""
    # No setting of the daemon's, which only config may read: clients are programs of others, and have no config.
    return os.environ.get("ROBOTD_RUNTIME_DIR") or DEFAULT_RUNTIME_DIR


@dataclass(frozen=True, slots=True)
class Endpoints:
    """The sockets of one daemon, all in its runtime directory.

    Raises:
        TransportError: the directory's path is too long for a Unix socket.
    """

    runtime_dir: Path

    def __post_init__(self) -> None:
        """Refuse a path that the kernel would."""
        longest = max((len(os.fsencode(path)), str(path)) for path in self.paths)
        if longest[0] > _LONGEST_PATH:
            raise TransportError(f"{longest[1]}: {longest[0]} bytes, a Unix socket's path has at most {_LONGEST_PATH}")

    def __str__(self) -> str:
        """Who serves there."""
        return f"robotd in {self.runtime_dir}"

    @property
    def commands(self) -> str:
        """Requests and replies (ROUTER)."""
        return f"ipc://{self.paths[0]}"

    @property
    def state(self) -> str:
        """Everything small that is published (XPUB)."""
        return f"ipc://{self.paths[1]}"

    @property
    def maps(self) -> str:
        """Maps, apart, so that a slow reader of maps never misses a pose for it (XPUB)."""
        return f"ipc://{self.paths[2]}"

    @property
    def paths(self) -> tuple[Path, Path, Path]:
        """The files of the sockets: commands, state, maps."""
        # Absolute: a program may change its directory between two connections.
        directory = self.runtime_dir.absolute()
        return directory / "commands.sock", directory / "state.sock", directory / "maps.sock"
