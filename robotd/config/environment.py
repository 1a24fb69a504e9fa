"""What the environment decides: where the configuration is, and the directories that systemd made for us."""

import os
from pathlib import Path

_FILE = "/etc/robotd/robotd.toml"


def default_path() -> Path:
    """Return the configuration to read if none is named: ``$ROBOTD_CONFIG``, or the system's."""
    return Path(os.environ.get("ROBOTD_CONFIG") or _FILE)


def runtime_dir() -> str:
    """Return the directory for sockets: ``$RUNTIME_DIRECTORY`` of systemd, or the one it makes by default."""
    return _first("RUNTIME_DIRECTORY") or "/run/robotd"


def state_dir() -> str:
    """Return the directory for what must last: ``$STATE_DIRECTORY`` of systemd, or the one it makes by default."""
    return _first("STATE_DIRECTORY") or "/var/lib/robotd"


def variable(name: str) -> str | None:
    """Return what a variable of the environment holds; None if there is none."""
    return os.environ.get(name)


def home_of(user: str) -> str:
    """Return the home of ``~``, the user that we run as, or of ``~name``.

    Raises:
        ValueError: there is none.
    """
    try:
        return str(Path(user).expanduser())
    except RuntimeError:
        raise ValueError(f"{user} is the home of nobody: write the path out") from None


def _first(variable: str) -> str:
    """Return the first of the directories in a variable; systemd.exec(5) allows several, with colons between."""
    return os.environ.get(variable, "").partition(":")[0]
