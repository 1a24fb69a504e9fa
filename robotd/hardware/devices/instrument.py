"""What a rangefinder can have measured: the one place where a distance becomes a reading, for all dialects.

A right checksum says that a distance came as it was sent, not that it can be one. What is farther than the model
reaches is the instrument's mistake (a sentinel that nobody documented, a phase that slipped), and says nothing about
the room: taken for a miss, it would clear cells as far as the cut-off.
"""

from robotd.core.reading import ReadingStatus
from robotd.hardware.devices.rangefinder import Shot
from robotd.hardware.devices.settings import RangefinderSettings


class Instrument:
    """One rangefinder's reach and bias, and how often it said what cannot be."""

    def __init__(self, settings: RangefinderSettings, reach_m: float) -> None:
        """Take how far its model can measure at all, on the best of targets, for what it may say."""
        self.reach_m = reach_m
        self._bias_m = settings.range_bias_m
        self.implausible = 0
        """Distances below zero or beyond its reach, since start."""

    def shot(self, time_ns: int, distance_m: float, strength: int | None, *, reach_m: float | None = None) -> Shot:
        """Return the reading of a distance along the beam, as measured; a device error if it cannot be one.

        Args:
            time_ns: when it was measured, clock of this host.
            distance_m: without bias.
            strength: as the device counts it.
            reach_m: how far this very device says that it measures; it is believed up to its model's reach.
        """
        if not 0.0 <= distance_m <= min(self.reach_m, self.reach_m if reach_m is None else reach_m):
            self.implausible += 1
            return Shot(time_ns, ReadingStatus.DEVICE_ERROR, None, strength)
        return Shot(time_ns, ReadingStatus.OK, distance_m + self._bias_m, strength)

    def nothing_within(self, time_ns: int, reach_m: float, strength: int | None) -> Shot:
        """Return the reading of a beam that met nothing as far as the device measures."""
        # Never farther than its model sees, whatever it claims: a miss clears cells all along its way.
        return Shot(time_ns, ReadingStatus.MISS, min(reach_m, self.reach_m), strength)
