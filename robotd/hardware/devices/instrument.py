"""What a rangefinder can have measured: the one place where a distance becomes a reading, for all dialects.

A right checksum says that a distance came as it was sent, not that it can be one. What is farther than the model
reaches is the instrument's mistake (a sentinel that nobody documented, a phase that slipped), and says nothing about
the room: taken for a miss, it would clear cells as far as the cut-off.
"""

from collections.abc import Mapping

from robotd.core.reading import ReadingStatus
from robotd.hardware.devices.rangefinder import Shot
from robotd.hardware.devices.settings import RangefinderSettings

_ANY_INSTRUMENT_M = 500.0

REACH_M: Mapping[str, float] = {
    "board": _ANY_INSTRUMENT_M,
    "dimetix": 500.0,
    "disto": 200.0,
    "lw20": 100.0,
    "lwnx": 100.0,
    "scip": 120.0,
    "tfmini": 15.0,
    "tfmini-s": 15.0,
    "tfmini-plus": 15.0,
    "tf-luna": 10.0,
}
"""How far each model can measure at all, by dialect: on the best of targets, where the maker names one, and a quarter
beyond the maker's figure in the TFmini family, whose devices do read so far on bright walls."""


class Instrument:
    """One rangefinder's reach and bias, and how often it said what cannot be."""

    def __init__(self, settings: RangefinderSettings) -> None:
        """Take its dialect for its model."""
        self.reach_m = REACH_M.get(settings.dialect, _ANY_INSTRUMENT_M)
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
        return Shot(time_ns, ReadingStatus.MISS, min(reach_m, self.reach_m), strength)
