"""Where a line is: a path, or a host and a port."""

import urllib.parse

from robotd.core.errors import ConfigError


def host_and_port(address: str) -> tuple[str, int] | None:
    """Return where to connect to; None for a path.

    Args:
        address: ``/dev/serial/by-id/...`` or another absolute path, or ``tcp://host:port``.

    Raises:
        ConfigError: it is neither.
    """
    if address.startswith("/"):
        return None
    parts = urllib.parse.urlsplit(address)
    try:
        port = parts.port
    except ValueError:
        port = None
    # A path is a slip of somebody who thinks of URLs, and port 0 is no port to connect to.
    if parts.scheme != "tcp" or not parts.hostname or not port or parts.path:
        raise ConfigError(f"expected a device path or tcp://host:port, got {address!r}")
    return parts.hostname, port
