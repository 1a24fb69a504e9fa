"""When to stop looking: at two answers in a row that agree, with enough between them that is new.

One ``localized`` after a dozen readings can be wrong where rooms are alike, by the luck of where those readings ended;
two in a row, with new readings to several sides between, seldom are. But who asks again and again until an answer is
sure gives luck as many chances. So each answer must be surer than that of a whole sweep: with the contrast of one,
7 of 40 looks in a world of two equal rooms were sure of the wrong one, some of them at the first answer.
"""

from dataclasses import dataclass, field

from robotd.contract.estimate import PoseEstimate, PoseState
from robotd.core.angles import wrap_rad
from robotd.sensing.spread import quadrants

FIRST = 12
"""Readings before the first answer is asked for."""
CONTRAST_MIN = 3.0
"""Standard errors that the best place must stand out by from any other: by chance it is reached once in 700 times."""
_BETWEEN, _SHARE_BETWEEN = 4, 0.15
"""Readings before the next: at least these, and where the answer takes long this share of all, so that few are asked
for in vain."""
_NEW, _QUADRANTS = 4, 2
"""Readings between two answers that count, and to how many sides."""


@dataclass(slots=True)
class UntilSure:
    """Follows the answers of one look round."""

    near_m: float
    """Poses nearer than this, and with headings nearer than ``near_rad``, are one place."""
    near_rad: float
    is_sure: bool = False
    """Whether two answers agree."""
    _before: PoseEstimate | None = None
    """The last answer, if that was sure of a place."""
    _new_rad: list[float] = field(default_factory=list)
    """Bearings that were measured since."""

    def wanted(self, taken: int) -> int:
        """Return how many more readings to take before the next answer is asked for."""
        if taken < FIRST:
            return FIRST - taken
        # Once an answer was sure the next is asked for soon: it may be the one that ends it.
        return _BETWEEN if self._before is not None else max(_BETWEEN, round(_SHARE_BETWEEN * taken))

    def measured(self, bearing_rad: float) -> None:
        """Take note of a reading that says something."""
        self._new_rad.append(bearing_rad)

    def answered(self, estimate: PoseEstimate) -> None:
        """Take the answer after the readings so far."""
        if estimate.state is not PoseState.LOCALIZED or estimate.best is None:
            # One that is not sure breaks the row: two in a row must agree, not two of many.
            self._before = None
            self._new_rad.clear()
            return
        if self._before is None or not self._agrees(estimate):
            # The newer one is what the next must agree with: it knows all that the older one knew.
            self._before = estimate
            self._new_rad.clear()
            return
        self.is_sure = len(self._new_rad) >= _NEW and quadrants(self._new_rad) >= _QUADRANTS

    def _agrees(self, estimate: PoseEstimate) -> bool:
        before = self._before.best if self._before is not None else None
        assert before is not None  # only what is sure is kept
        assert estimate.best is not None
        turned_rad = abs(wrap_rad(before.heading_rad - estimate.best.heading_rad))
        return before.distance_m(estimate.best) <= self.near_m and turned_rad <= self.near_rad
