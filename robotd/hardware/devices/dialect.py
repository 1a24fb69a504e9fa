"""What a dialect brings to a device: all that there is to say of it in the daemon is named in one row."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from robotd.hardware.devices.settings import PortSettings
from robotd.hardware.devices.wiring import Wiring
from robotd.hardware.transport.line_format import LineFormat
from robotd.hardware.wire.enquiry import Enquiry, NotAsked
from robotd.hardware.wire.word import Words

S_co = TypeVar("S_co", bound=PortSettings, covariant=True)
D_co = TypeVar("D_co", covariant=True)


@dataclass(frozen=True, slots=True)
class Line:
    """The line to a device, and what passes on it, each way."""

    usual: LineFormat
    """What such a device is usually set to."""
    wire: type[object]
    """Reads what comes from it."""
    words: Words
    """Say what is written to it."""
    enquiry: Enquiry | NotAsked
    """How it is found where nobody said what is plugged in."""


@dataclass(frozen=True, slots=True)
class Dialect(Generic[S_co, D_co]):
    """One way to talk to a kind of device."""

    options: type[S_co]
    """Its section of the configuration: the options of the device, and those of this dialect alone."""
    adapter: Callable[[Any, Wiring], D_co]
    """Makes the device from its options."""
    line: Line | None
    """None for a device without a line."""
    hazards: tuple[str, ...] = ()
    """What anyone who stands beside the robot must know, in sentences; ``docs/devices.md`` says them, too."""
