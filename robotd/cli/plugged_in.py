"""Serial ports that are plugged in, by the names that stay."""

from dataclasses import dataclass
from pathlib import Path

from serial.tools import list_ports

_BY_ID = Path("/dev/serial/by-id")


@dataclass(frozen=True, slots=True)
class Port:
    """One port."""

    path: str
    """Under ``/dev/serial/by-id`` if it is there: that name stays when it is plugged in again."""
    about: str
    """What it says of itself."""


def plugged_in() -> tuple[Port, ...]:
    """Return the serial ports of this machine."""
    names = {str(link.resolve()): str(link) for link in sorted(_BY_ID.glob("*"))} if _BY_ID.is_dir() else {}
    found = (Port(names.get(port.device, port.device), str(port.description)) for port in list_ports.comports())
    return tuple(sorted(found, key=lambda port: port.path))
