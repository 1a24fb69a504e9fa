"""What ``robotd-gateway.toml`` says."""

import ipaddress
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from robotd.core.bounds import Within, refuse_outside

UNDERSTOOD = "i understand"
DEFAULT_FILE = "/etc/robotd/robotd-gateway.toml"


@dataclass(frozen=True, slots=True)
class ListenSettings:
    """Where browsers come in."""

    host: str = "127.0.0.1"
    """Address; another than this machine's own needs TLS, a proxy that has it, or a word that it is known not to."""
    port: Annotated[int, Within(0, 65535)] = 8470
    """0 takes any that is free, and says which."""
    allowed_hosts: tuple[str, ...] = ()
    """Names that the robot is reached by, beside those of this machine itself."""
    trusted_proxies: tuple[str, ...] = ()
    """Addresses of proxies that have TLS; what they say of an address and a scheme is believed, for logs and limits."""
    tls_certificate: str = ""
    tls_key: str = ""
    plaintext: str = ""
    """``i understand``: that who hears the network hears the tokens."""

    def __post_init__(self) -> None:
        """Refuse to be heard by everybody by mistake."""
        refuse_outside(self)
        if bool(self.tls_certificate) != bool(self.tls_key):
            raise ValueError("tls_certificate and tls_key go together")
        for address in self.trusted_proxies:
            ipaddress.ip_address(address)
        if not (self.is_local or self.has_tls or self.trusted_proxies or self.plaintext == UNDERSTOOD):
            raise ValueError(
                f"host {self.host} is heard by others: set tls_certificate and tls_key, or trusted_proxies,"
                f' or plaintext = "{UNDERSTOOD}"'
            )

    @property
    def has_tls(self) -> bool:
        """Whether we speak TLS ourselves."""
        return bool(self.tls_certificate)

    @property
    def is_local(self) -> bool:
        """Whether only programs of this machine reach us."""
        try:
            return ipaddress.ip_address(self.host).is_loopback
        except ValueError:
            return self.host == "localhost"


@dataclass(frozen=True, slots=True)
class RobotSettings:
    """Which robot this gateway serves: where its daemon listens, and what people call it."""

    name: str = "robot"
    """What pages call it."""
    runtime_dir: str = "/run/robotd"
    """Where the daemon has its sockets."""
    recordings: str = "/var/lib/robotd/recordings"
    """Where the daemon puts recordings; they are read, never written."""

    def __post_init__(self) -> None:
        """Refuse a robot without a name."""
        if not 1 <= len(self.name) <= 64:
            raise ValueError("name must have 1 to 64 letters")


@dataclass(frozen=True, slots=True)
class WatchingSettings:
    """How a mission is watched over that somebody started in a browser."""

    patience_s: Annotated[float, Within(0.5, 5.0, "s")] = 1.5
    """How long the page of who drives may leave questions unanswered before the robot is stopped."""
    unattended: bool = False
    """Whether missions may be started that go on though nobody looks."""
    disarm_after_s: Annotated[float, Within(10.0, 86_400.0, "s")] = 120.0
    """A robot that was armed here and stands idle is disarmed after so long."""

    def __post_init__(self) -> None:
        """Refuse what lies out of bounds."""
        refuse_outside(self)


@dataclass(frozen=True, slots=True)
class AccessSettings:
    """Who may come in, and for how long."""

    state_dir: str = field(default_factory=lambda: _first("STATE_DIRECTORY") or "/var/lib/robotd-gateway")
    """Where tokens and sessions are kept."""
    idle_h: Annotated[float, Within(0.1, 720.0, "h")] = 12.0
    """A session that nobody uses ends after so long."""
    metrics_without_token: bool = False
    """Whether programs of this machine may read ``/metrics`` without a token."""

    def __post_init__(self) -> None:
        """Refuse what lies out of bounds."""
        refuse_outside(self)

    @property
    def tokens(self) -> Path:
        """The file of tokens."""
        return Path(self.state_dir) / "tokens.json"

    @property
    def sessions(self) -> Path:
        """The file in which sessions outlive the gateway."""
        return Path(self.state_dir) / "sessions.json"


@dataclass(frozen=True, slots=True)
class GatewaySettings:
    """All of it; each field is a section."""

    listen: ListenSettings = field(default_factory=ListenSettings)
    robot: RobotSettings = field(default_factory=RobotSettings)
    watching: WatchingSettings = field(default_factory=WatchingSettings)
    access: AccessSettings = field(default_factory=AccessSettings)


def _first(variable: str) -> str:
    """Return the first of the directories in a variable; systemd.exec(5) allows several, with colons between."""
    return os.environ.get(variable, "").partition(":")[0]
