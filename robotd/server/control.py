"""What the server needs from the daemon."""

from typing import Protocol

from robotd.contract.events import Event, MapChanged, Status
from robotd.contract.missions import Mission
from robotd.core.broadcast import Broadcast
from robotd.core.pose import Pose2
from robotd.maps.entry import MapEntry


class Control(Protocol):
    """The daemon, as far as clients may reach.

    Its errors become replies: ``MapError`` is ``not_found``, ``ConfigError`` is ``bad_argument``, every other
    ``RobotdError`` is ``refused`` with its message, and what is none of them is ``internal``.
    """

    @property
    def events(self) -> Broadcast[Event]:
        """Everything that happens."""

    @property
    def status(self) -> Status:
        """The whole robot in one look, now."""

    @property
    def config_text(self) -> str:
        """The effective configuration, as TOML."""

    async def arm(self) -> None:
        """Allow motion; cancelled when a stop overtakes it."""

    def halt(self, reason: str) -> None:
        """Stop everything and disarm; valid at any time. The stop is on the wire when this returns."""

    async def stopped(self) -> None:
        """Wait until the mission that was stopped has ended."""

    async def clear(self) -> None:
        """Acknowledge latched faults; the robot stays disarmed."""

    async def begin(self, mission: Mission, lease_s: float) -> int:
        """Start a mission under a lease and return its number; the map in use is not lost by it.

        Raises:
            MissionError: not now; says why.
        """

    def renew(self, mission_id: int) -> None:
        """Keep a mission's lease alive.

        Raises:
            MissionError: that mission is not under way.
        """

    def whole_map(self) -> MapChanged:
        """Return all of the map in use, as a snapshot that nobody changes any more.

        Raises:
            MapError: there is none.
        """

    async def stored_map(self, name: str, version: int | None) -> MapChanged:
        """Return all of a stored map, the newest version unless one is named; ``MapError`` if there is none."""

    async def save_map(self, name: str | None) -> MapEntry:
        """Store the map in use, under its own name unless one is given; ``MapError`` if there is none, or no room."""

    async def load_map(self, name: str, version: int | None, robot_in_map: Pose2 | None) -> MapEntry:
        """Take a stored map into use; ``MapError`` if there is none, ``MissionError`` if that cannot be now."""

    def discard_map(self) -> None:
        """Give up what nobody saved of the map in use; ``MapError`` if there is none, ``MissionError`` not now."""

    async def list_maps(self) -> tuple[MapEntry, ...]:
        """Return the stored maps."""

    async def start_recording(self, path: str | None) -> str:
        """Start recording, to a file of the daemon's choice unless one is named, and return where."""

    async def stop_recording(self) -> str | None:
        """Close the recording and return where it is, or None if there was none."""
