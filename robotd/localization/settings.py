"""What counts as explained, and what as an answer."""

import math
from dataclasses import dataclass
from typing import Annotated

from robotd.core.bounds import Within, refuse_outside
from robotd.localization.even_headings import even_headings
from robotd.localization.heading_search import HeadingSearch
from robotd.localization.obstacles.error_radius import ErrorRadius
from robotd.localization.obstacles.thick_walls import ThickWalls
from robotd.localization.obstacles.unknown_cells import UnknownCells
from robotd.localization.stop_poses import StopPoses


@dataclass(frozen=True, slots=True)
class LocalizationSettings:
    """What counts as explained, and what as an answer.

    The defaults were chosen on simulated rooms and on two real buildings (5 cm cells, 120 kept-out scans each): the
    true pose explained 75 to 90 % of the readings, the best pose in a building where the robot was not 17 to 69 %.
    """

    range_error_m: Annotated[float, Within(0.0, 1.0, "m")] = 0.075
    """The paper's eps: how far an obstacle on the map may lie from the head of a reading."""
    error_radius: ErrorRadius = ErrorRadius.BY_RANGE
    """Whether eps is the same for all readings, as in the paper (``constant``), or grows with what an angle makes of a
    range, half a heading step and ``bearing_error_rad``, and is no less than cells round away (``by_range``)."""
    bearing_error_rad: Annotated[float, Within(0.0, 0.5, "rad")] = 0.004
    """How far off the bearing of a reading may be: the map-maker's headings, and the head's own."""
    heading_error_rad: Annotated[float, Within(0.0, math.pi, "rad")] = 0.0175
    """How far the heading that odometry gives may be off: headings up to so far away are tried too."""
    heading_step_rad: Annotated[float, Within(1e-4, math.pi / 4, "rad")] = 0.00873
    """Step between the headings that are tried; half a degree, as the beams of many scanners lie."""
    heading: HeadingSearch = HeadingSearch.ALL
    """Which headings are tried where nothing is known of the heading: ``all``, or only those that ``walls`` name, where
    they name one that explains the readings; quicker, and wrong where what is seen has another axis than the map."""
    localized_share: Annotated[float, Within(0.01, 1.0, "of 1")] = 0.5
    """Share of the readings that the best pose must explain; below it the robot is lost."""
    rival_share: Annotated[float, Within(0.0, 0.99, "of 1")] = 0.15
    """A pose is still an answer if it explains fewer readings than the best by no more than this share of all."""
    readings_min: Annotated[int, Within(1, 10_000)] = 12
    """With fewer readings than this nothing is said."""
    regions_max: Annotated[int, Within(1, 10_000)] = 32
    """Most regions that an estimate lists, best first; of the others it says how many there are."""
    unknown: UnknownCells = UnknownCells.BLOCKS_ONLY
    """What a cell is taken for that nobody has seen: ``occupied`` as in the paper, ``blocks_only`` or ``free``."""
    blocked_by: Annotated[int, Within(1, 2)] = 2
    """How many obstacle cells a beam must meet before its end to be blocked: 1 as in the paper, or 2, so that a beam
    that grazes along a wall is not."""
    thick_walls: ThickWalls = ThickWalls.EITHER
    """Where the faces of walls are that are thicker than 10 cm: ``as_drawn``, or ``either`` there or somewhere inside,
    as on maps that were drawn with a broad pen."""
    stops: StopPoses = StopPoses.PLACED
    """Where the stops of a map in the making are: ``placed`` on the map so far, or where ``odometry`` has them."""
    history: bool = True
    """Whether the places that a look leaves are carried to the next stop, where only those count that the robot can
    have come to; else each look is held against the last sure one alone."""
    budget_s: Annotated[float, Within(0.01, 3600.0, "s")] = 1.0
    """About how long a search may take on the reference machine. It is counted in what is looked at, never in time: a
    slower or busier machine takes longer and finds the same. If it runs out, the answer is ``ambiguous`` and not
    complete."""
    conservative: bool = False
    """Whether no place is excluded but by proof: the true one is then always among the answers, as long as ranges err
    by no more than ``range_error_m``, the heading by no more than half a step from one that is tried, and cells that
    were seen are right. Slower, and more often ambiguous."""
    outlier_share: Annotated[float, Within(0.0, 0.99, "of 1")] = 0.1
    """In the conservative mode, this many of the readings may err by more."""

    def __post_init__(self) -> None:
        """Refuse impossible values."""
        refuse_outside(self)
        if self.conservative and self.heading_step_rad > math.pi / 4:
            raise ValueError(f"heading_step_rad must be at most pi / 4 where conservative, got {self.heading_step_rad}")

    def error_radius_cells(self, resolution_m: float) -> float:
        """Return the error radius in cells, as it was meant: 0.15 m on cells of 0.05 m is 3, not 2.9999999999999996.

        A disk of three cells has 29, one of a hair less 25.

        >>> LocalizationSettings(range_error_m=0.15).error_radius_cells(0.05)
        3.0
        """
        return round(self.range_error_m / resolution_m, 9)

    def headings_near(self, heading_rad: float) -> tuple[float, ...]:
        """Return the headings to try when odometry says ``heading_rad``, in ascending order.

        >>> LocalizationSettings(heading_error_rad=0.2, heading_step_rad=0.1).headings_near(1.0)
        (0.8, 0.9, 1.0, 1.1, 1.2)
        """
        # A quotient such as 0.3 / 0.1 comes out just below 3: no step is to be lost to rounding.
        steps = math.floor(self.heading_error_rad / self.heading_step_rad + 1e-9)
        return tuple(heading_rad + step * self.heading_step_rad for step in range(-steps, steps + 1))

    def headings_all_round(self) -> tuple[float, ...]:
        """Return the headings to try when nothing is known, evenly all round, in steps no longer than the setting."""
        # The other way round here: rounding must not add a slice.
        return even_headings(math.ceil(math.tau / self.heading_step_rad - 1e-9))
