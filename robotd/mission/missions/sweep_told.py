"""A sweep under way, as the world is told it: that it began, its readings a few at a time, and how far it is."""

from collections.abc import Callable

from robotd.contract.events import Event, SweepBegun, SweepProgress
from robotd.contract.sweep_columns import in_columns
from robotd.core.clock import NS_PER_S, now_ns
from robotd.core.pose import Pose2
from robotd.core.reading import RangeReading, ReadingStatus

_PROGRESS_EVERY = 10
_READINGS_HZ = 20.0
"""How often readings are told: who draws them needs no more, and what is told together costs little."""
_KINDS = {ReadingStatus.OK: "hits", ReadingStatus.MISS: "misses"}


class SweepTold:
    """Publishes the readings of a sweep as they come, and every tenth count of them."""

    def __init__(
        self, number: int, total: int, publish: Callable[[Event], None], in_map: Callable[[Pose2], Pose2 | None]
    ) -> None:
        """Tell of sweep ``number``; ``in_map`` says where a pose in the odometry frame lies on the map."""
        self._number = number
        self._total = total
        self._publish = publish
        self._in_map = in_map
        self._counts = {"hits": 0, "misses": 0, "rejected": 0}
        self._untold: list[RangeReading] = []
        self._told_ns: int | None = None

    def begun(self, in_odom: Pose2) -> None:
        """Tell that it begins here."""
        self._publish(SweepBegun(now_ns(), self._number, self._total, in_odom, self._in_map(in_odom)))

    def read(self, reading: RangeReading) -> None:
        """Count one reading."""
        self._counts[_KINDS.get(reading.status, "rejected")] += 1
        taken = sum(self._counts.values())
        is_last = taken == self._total
        self._untold.append(reading)
        # By the times of the readings: then what is told together is the same in a replay.
        if is_last or self._told_ns is None or reading.time_ns - self._told_ns >= NS_PER_S / _READINGS_HZ:
            self._publish(in_columns(self._number, taken - len(self._untold), self._untold))
            self._untold.clear()
            self._told_ns = reading.time_ns
        if is_last or taken % _PROGRESS_EVERY == 0:
            self._publish(SweepProgress(now_ns(), self._number, taken, self._total, **self._counts))
