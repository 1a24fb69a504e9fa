"""The one that stops the robot (the supervisor), as far as those that watch over it need it."""

from typing import Protocol

from robotd.contract.modes import Mode
from robotd.mission.safety.mode_table import Occasion
from robotd.mission.three_devices import Robot


class Stopper(Protocol):
    """Stops first, and then does the rest."""

    robot: Robot
    halts: int
    """How often the robot was stopped: who waited for something sees whether a stop came between."""

    @property
    def mode(self) -> Mode:
        """What the robot is allowed to do now."""

    def halt(self, occasion: Occasion, reason: str) -> None:
        """Stop first, then end the mission."""

    def publish_status(self) -> None:
        """Tell everybody how the whole robot is."""
