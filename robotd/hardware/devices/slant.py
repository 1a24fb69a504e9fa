"""A beam that points up or down, on a map without heights: where it begins, how far it goes, where the floor is."""

import math
from dataclasses import dataclass

from robotd.hardware.devices.calibration import HeadMount


@dataclass(frozen=True, slots=True)
class SlantedBeam:
    """A beam as a map without heights has it."""

    start_x_m: float
    start_y_m: float
    """Where it leaves the head, robot frame."""
    start_z_m: float
    """How high above the floor it does; of no account if nobody measured how high the head is."""
    per_m: float
    """How far each metre along it leads on the map."""
    floor_m: float
    """How far from its start, on the map, it meets the floor; infinite if it never does, or if nobody measured that."""


def slanted_beam(mount: HeadMount, pan_rad: float, tilt_rad: float) -> SlantedBeam:
    """Return the beam of a head that looks somewhere: counter-clockwise from the robot's heading, and up from level.

    >>> beam = slanted_beam(HeadMount(height_m=0.55), 0.0, -0.24)
    >>> round(beam.per_m, 3), round(beam.floor_m, 2)
    (0.971, 2.25)
    """
    sine, cosine = math.sin(tilt_rad), math.cos(tilt_rad)
    # The lens goes round the tilt axis first, and with it round the pan axis.
    ahead_m = mount.lens_ahead_m * cosine - mount.lens_up_m * sine
    height_m = mount.height_m + mount.lens_ahead_m * sine - mount.lens_up_m * (1.0 - cosine)
    meets_floor = tilt_rad < 0.0 and mount.height_m > 0.0
    return SlantedBeam(
        mount.x_m + ahead_m * math.cos(pan_rad),
        mount.y_m + ahead_m * math.sin(pan_rad),
        height_m,
        cosine,
        height_m * cosine / -sine if meets_floor else math.inf,
    )
