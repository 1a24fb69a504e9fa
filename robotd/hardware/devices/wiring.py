"""What a device is built into."""

import random
from dataclasses import dataclass, field

from robotd.hardware.devices.gaze import Gaze
from robotd.hardware.link.tap import Tap
from robotd.hardware.transport.transport import Connect


@dataclass(frozen=True, slots=True)
class Wiring:
    """The same for hardware, tests and replay; only its parts differ."""

    connect: Connect
    """Opens the line to the device, again after each loss."""
    tap: Tap
    """Sees every byte."""
    rng: random.Random
    """Where the nonces of the handshakes come from."""
    gaze: Gaze = field(default_factory=Gaze)
    """Where a scanner looks; the same for all devices of a robot."""
