"""Maps that are made of stops, for the tests of the store."""

import math

import numpy as np

from robotd.core.grid_spec import GridSpec
from robotd.core.map_stop import MapStop
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus, Sweep
from robotd.grid.map_stops import MapStops
from robotd.grid.settings import GridSettings

SPEC = GridSpec(0.1, -1.5, -1.0, (20, 30))
_STATUSES = tuple(ReadingStatus)


def made_stops(seed: int, stops: int = 2, readings: int = 12, settings: GridSettings | None = None) -> MapStops:
    """Return stops in a space without walls, every status among their readings."""
    rng = np.random.default_rng(seed)
    made = MapStops(settings or GridSettings())
    for number in range(stops):
        pose = Pose2(*rng.uniform(-0.8, 0.8, 3).tolist())
        sweep = Sweep(number, Pose2(*rng.uniform(-9.0, 9.0, 3).tolist()), made_readings(rng, readings))
        made = made.with_stop(MapStop.of(sweep, pose))
    return made


def made_readings(rng: np.random.Generator, count: int) -> tuple[RangeReading, ...]:
    """Return readings all round, of every status if they are enough."""
    return tuple(
        RangeReading(
            time_ns=10**15 + 10**8 * number + int(rng.integers(0, 10**6)),
            bearing_rad=number * math.tau / count + float(rng.normal(0.0, 1e-3)),
            status=status,
            range_m=float(rng.uniform(0.2, 2.0)) if status in {ReadingStatus.OK, ReadingStatus.MISS} else None,
            strength=int(rng.integers(0, 4096)) if number % 3 else None,
            origin_x_m=0.05,
            origin_y_m=-0.01,
        )
        for number in range(count)
        for status in [_STATUSES[number // 2 % len(_STATUSES)] if number % 2 else ReadingStatus.OK]
    )
