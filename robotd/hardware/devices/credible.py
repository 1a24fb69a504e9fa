"""The gate between what a device says and SI values, one for all dialects and boards.

A right checksum says that a message came as it was sent, not that it is true: a board with a broken sensor, a swapped
word or a fault in its firmware speaks clearly and says what cannot be. What passes here is finite and within what a
robot of this kind can be; all else is a fault of its device, counted as ``implausible``, latched, and the robot stops.
Distances are judged in :mod:`robotd.hardware.devices.instrument`, for one that cannot be is only a failed reading.
"""

import math

from robotd.core.angles import wrap_rad
from robotd.core.clock import NS_PER_S
from robotd.core.errors import DeviceError
from robotd.core.pose import Twist2
from robotd.hardware.devices.pantilt import AimReadback, PanTiltLimits
from robotd.hardware.link.clock_sync import AHEAD_MAX_NS

IMPLAUSIBLE = "implausible"
"""The latched fault of a device that said what cannot be, and the code of the DeviceError."""

SPEED_MAX_MPS = 10.0
TURN_MAX_RADPS = 20.0
"""No synchro-drive is a fifth as quick; what is beyond was not measured."""
UNSEEN_S = 0.25
"""How much longer than between their times a base may have moved between two reports: times are those of reading."""
BATTERY_MAX_V = 150.0
"""Beyond any pack of a robot: like all bounds here it finds broken devices, not inaccurate ones (decision 19)."""
PAN_MAX_RAD = 4 * math.tau
TILT_MAX_RAD = math.radians(120.0)
OFF_AIM_MAX_RAD = 0.35
"""A head that says that it is where it was told is not farther from there than this."""
LATE_S = 0.5
"""After a stall what was kept in buffers is late, and soon caught up with: only what stays farther behind is no true
time."""
OLD_MAX_S = 60.0
"""No stall and no buffer makes a message older than this."""


def check_twist(device: str, twist: Twist2) -> None:
    """Raise DeviceError if no base moves so fast."""
    # *Not within* instead of *beyond*, here and below: what is not a number lies within nothing.
    if not (abs(twist.speed_mps) <= SPEED_MAX_MPS and abs(twist.turn_radps) <= TURN_MAX_RADPS):
        raise implausible(device, f"it moves at {twist.speed_mps:g} m/s and {twist.turn_radps:g} rad/s")


def check_way(device: str, way_m: float, turn_rad: float, elapsed_s: float) -> None:
    """Raise DeviceError if no base gets so far, or turns so far, in the time between two reports."""
    seconds = max(0.0, elapsed_s) + UNSEEN_S  # a report said twice is not older than itself
    if not (abs(way_m) <= SPEED_MAX_MPS * seconds and abs(turn_rad) <= TURN_MAX_RADPS * seconds):
        raise implausible(device, f"it moved {way_m:g} m and turned {turn_rad:g} rad in {elapsed_s:.3f} s")


def battery_v(device: str, volts: float) -> float | None:
    """Return what a base says of its battery; None if it has not measured it yet, which all say as zero.

    Raises:
        DeviceError: no battery of a robot has such a voltage.
    """
    if not 0.0 <= volts <= BATTERY_MAX_V:
        raise implausible(device, f"its battery is at {volts:g} V")
    return volts or None


def check_readback(device: str, readback: AimReadback, pan_rad: float, tilt_rad: float) -> None:
    """Raise DeviceError if a head says that it came to rest where it was not told to, or where no head can be."""
    off_rad = max(abs(wrap_rad(readback.pan_rad - pan_rad)), abs(readback.tilt_rad - tilt_rad))
    is_possible = abs(readback.pan_rad) <= PAN_MAX_RAD and abs(readback.tilt_rad) <= TILT_MAX_RAD
    if not (is_possible and off_rad <= OFF_AIM_MAX_RAD):
        at = f"({readback.pan_rad:.3f}, {readback.tilt_rad:.3f}) rad"
        raise implausible(device, f"told to aim at ({pan_rad:.3f}, {tilt_rad:.3f}) rad, it says that it rests at {at}")


def check_limits(device: str, limits: PanTiltLimits) -> None:
    """Raise DeviceError if no head has such limits."""
    is_ordered = limits.pan_min_rad < limits.pan_max_rad and limits.tilt_min_rad <= limits.tilt_max_rad
    angles_rad = (limits.pan_min_rad, limits.pan_max_rad)
    tilts_rad = (limits.tilt_min_rad, limits.tilt_max_rad)
    is_possible = all(abs(pan) <= PAN_MAX_RAD for pan in angles_rad) and all(abs(t) <= math.tau for t in tilts_rad)
    if not (is_ordered and is_possible):
        raise implausible(device, f"it says that it pans and tilts within {angles_rad}, {tilts_rad} rad")


class Times:
    """Judges the times of one conversation's messages by when they were heard."""

    def __init__(self, device: str, patience_s: float) -> None:
        """Judge a device whose times may stay behind for so long: as long as it may be silent altogether."""
        self._device = device
        self._patience_s = patience_s
        self._late_since_ns: int | None = None
        self._missed_s = 0.0

    def check(self, time_ns: int, heard_ns: int) -> None:
        """Raise DeviceError if a time, both of this host's clock, lies ahead of when it was heard, or far behind."""
        ahead_s = (time_ns - heard_ns) / NS_PER_S
        if not -OLD_MAX_S <= ahead_s <= AHEAD_MAX_NS / NS_PER_S:
            raise implausible(self._device, f"its clock is {abs(ahead_s):g} s {'ahead' if ahead_s > 0 else 'behind'}")

    def check_periodic(self, time_ns: int, heard_ns: int, missed_s: float = 0.0) -> None:
        """The same for what is said again and again; DeviceError also if its times have stayed behind for too long.

        Not while we stand still ourselves again and again, for ``missed_s`` in all: then it is us who are behind.
        """
        self.check(time_ns, heard_ns)
        if missed_s != self._missed_s:
            self._missed_s, self._late_since_ns = missed_s, None
        if heard_ns - time_ns <= LATE_S * NS_PER_S:
            self._late_since_ns = None
            return
        self._late_since_ns = heard_ns if self._late_since_ns is None else self._late_since_ns
        if heard_ns - self._late_since_ns > self._patience_s * NS_PER_S:
            raise implausible(self._device, f"its clock falls behind: {(heard_ns - time_ns) / NS_PER_S:.3f} s by now")


def implausible(device: str, what: str) -> DeviceError:
    """Return the error that says what cannot be."""
    return DeviceError(device, IMPLAUSIBLE, what)
