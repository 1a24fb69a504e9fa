"""Readings of a sweep under way as columns of bytes, and back: nine bytes a reading."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from robotd.contract.events import SweepReadings
from robotd.core.errors import RemoteProtocolError
from robotd.core.reading import RangeReading, ReadingStatus

_FLOAT = np.dtype("<f4")
_STATUSES = tuple(ReadingStatus)
_BYTES = {status: at for at, status in enumerate(_STATUSES)}


def in_columns(number: int, first: int, readings: Sequence[RangeReading]) -> SweepReadings:
    """Return some readings of sweep ``number``, one or more, of which the first is the sweep's ``first``."""
    # Left out where all beams start on the axis: nearly half of the bytes.
    is_off_centre = any(reading.origin_x_m or reading.origin_y_m for reading in readings)

    def column(value: Callable[[RangeReading], float]) -> bytes:
        # Single precision: a tenth of a millimetre at a kilometre, for what is drawn and not computed on.
        return np.array([value(reading) for reading in readings], _FLOAT).tobytes()

    return SweepReadings(
        time_ns=readings[-1].time_ns,
        number=number,
        first=first,
        bearing_f32le=column(lambda reading: reading.bearing_rad),
        range_f32le=column(lambda reading: math.nan if reading.range_m is None else reading.range_m),
        status_u8=bytes(_BYTES[reading.status] for reading in readings),
        origin_x_f32le=column(lambda reading: reading.origin_x_m) if is_off_centre else b"",
        origin_y_f32le=column(lambda reading: reading.origin_y_m) if is_off_centre else b"",
    )


def from_columns(told: SweepReadings) -> tuple[RangeReading, ...]:
    """Return the readings, in single precision; the time of each is that of the last.

    Raises:
        RemoteProtocolError: the columns contradict each other, or hold what no reading is.
    """
    try:
        count = len(told.status_u8)
        bearings_rad, ranges_m = (_floats(data, count) for data in (told.bearing_f32le, told.range_f32le))
        x_m, y_m = (_floats(data or bytes(4 * count), count) for data in (told.origin_x_f32le, told.origin_y_f32le))
        return tuple(
            RangeReading(
                told.time_ns, bearing_rad, _STATUSES[status], None if math.isnan(range_m) else range_m, None, *origin
            )
            for bearing_rad, range_m, status, *origin in zip(
                bearings_rad, ranges_m, told.status_u8, x_m, y_m, strict=True
            )
        )
    except (ValueError, IndexError) as error:
        raise RemoteProtocolError(f"readings of sweep {told.number}: {error}") from error


def _floats(data: bytes, count: int) -> list[float]:
    values: list[float] = np.frombuffer(data, _FLOAT).tolist()
    if len(values) != count:
        raise ValueError(f"a column of {len(values)} beside one of {count}")
    return values
