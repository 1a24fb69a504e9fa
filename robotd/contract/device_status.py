"""How a device is, as everybody may know: whether it answers, is armed, and what is wrong with it."""

import enum
from dataclasses import dataclass


class LinkState(enum.StrEnum):
    """Whether there is a device to talk to. A missing device is a state, not an error."""

    ABSENT = "absent"
    CONNECTING = "connecting"
    READY = "ready"


@dataclass(frozen=True, slots=True)
class DeviceStatus:
    """Health of one device, published whenever it changes."""

    name: str
    link: LinkState
    armed: bool
    faults: tuple[str, ...] = ()
    """Latched faults, in lower case; empty when there is none."""
    detail: str = ""
    """One line for people: why the link is absent, what the fault said."""
    counters: tuple[tuple[str, int], ...] = ()
    """What was counted on the line since start: frames, CRC errors, retries, reconnects."""
